#include "common.inc"
object { Ball texture { Mirror } translate <-1.6, 1, 0> }
object { Ball texture { Mirror finish { ambient 0 diffuse 0 reflection { 0.8, 1 falloff 5 } } } scale 0.8 translate <0.9, 0.8, 1> }
object { Cube texture { Mirror } scale <2.4, 1.6, 0.1> rotate -20 * y translate <0.6, 1.8, -2.6> }
object { Ball Matte(srgb <0.8, 0.2, 0.2>, 0.8) scale 0.6 translate <-0.3, 0.6, 2> }
object { Horn Matte(srgb <0.3, 0.4, 0.9>, 0.8) scale <1.6, 0.7, 0.7> rotate -90 * z translate <2.4, 1.6, 0> }
object { Cube Matte(srgb <0.7, 0.7, 0.7>, 0.8) scale <6, 0.5, 6> translate <0, -0.5, 0> }
Eye(<0, 3, 9>, <0, 1, 0>, 45)
