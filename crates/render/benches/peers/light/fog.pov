#include "common.inc"
object { Ball Matte(srgb <0.8, 0.2, 0.2>, 0.3) translate <-2.2, 1, 0> }
object { Rod Matte(srgb <0.2, 0.7, 0.3>, 0.3) scale <2, 0.8, 0.8> rotate 90 * z translate <0.4, 0, -3> }
object { Horn Matte(srgb <0.3, 0.4, 0.9>, 0.3) scale <2, 1, 1> rotate -90 * z translate <3.5, 2, -7> }
object { Ball texture { Mirror } scale 0.7 translate <0.6, 0.7, 2> }
object { Cube Matte(srgb <0.7, 0.7, 0.7>, 0.3) scale <30, 0.5, 30> translate <0, -0.5, 0> }
light_source { <-4, 7, 6> rgb 0.6 shadowless }
fog { fog_type 1 distance 7 / ln(2) color srgb <0.5, 0.6, 0.8> }
Eye(<0, 3, 9>, <0, 1, 0>, 35)
