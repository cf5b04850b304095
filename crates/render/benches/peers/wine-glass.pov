// The geometry of scenes/wine-glass for POV-Ray 3.7; against-povray.sh times both.
#version 3.7;
global_settings { assumed_gamma 1 max_trace_level 15 adc_bailout 1/256 }
#declare Glass = material { texture { pigment { rgbt <1,1,1,1> } finish { ambient 0 diffuse 0 reflection { 0, 1 fresnel on } conserve_energy } } interior { ior 1.65 fade_distance 1000 fade_power 1 } }
#declare Wine = material { texture { pigment { rgbt <1,0.1,0.1,1> } finish { ambient 0 diffuse 0 reflection { 0, 1 fresnel on } conserve_energy } } interior { ior 1.36 fade_distance 1000 fade_power 1 } }
#declare White = texture { pigment { rgb 1 } finish { ambient 0.3 diffuse 1 } }
merge {
  cone { <0,100,0>,0, <0,39.5,0>,200 }
  cylinder { <0,0,0>,<0,40.5,0>,200 }
  cylinder { <0,50,0>,<0,350,0>,20 }
  difference { cone { <0,300,0>,0, <0,700,0>,300 } cone { <0,320,0>,0, <0,720,0>,300 } }
  material { Glass }
}
cone { <0,320,0>,0, <0,600,0>,210 material { Wine } }
box { <-2000,-40,-2000>,<2000,0,2000> texture { White } }
box { <-2000,0,-2020>,<2000,4000,-1980> texture { White } }
light_source { <0,1000,-100> rgb 0.8 spotlight point_at <0,0,-2000> radius 62 falloff 62 tightness 1 }
background { rgb 0.402 }
camera { perspective location <0,1500,4000> right -x*0.48 up y*0.48 direction z*1 look_at <0,400,0> }
