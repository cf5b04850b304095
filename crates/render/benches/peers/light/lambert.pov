#include "common.inc"
object { Ball Matte(srgb <0.8, 0.2, 0.2>, 0.1) translate <-2.2, 1, 0> }
object { Rod Matte(srgb <0.2, 0.7, 0.3>, 0.1) scale <2, 0.8, 0.8> rotate 90 * z translate <0, 0, 0.5> }
object { Horn Matte(srgb <0.3, 0.4, 0.9>, 0.1) scale <2, 1, 1> rotate -90 * z translate <2.2, 2, 0> }
object { Cube Matte(srgb <0.9, 0.8, 0.3>, 0.1) scale <0.7, 0.4, 0.6> rotate 30 * y translate <0.3, 0.4, 2.4> }
object { Cube Matte(srgb <0.7, 0.7, 0.7>, 0.1) scale <6, 0.5, 6> translate <0, -0.5, 0> }
object { Cube Matte(srgb <0.6, 0.7, 0.8>, 0.1) scale <6, 4, 0.5> translate <0, 3, -4> }
light_source { <-4, 7, 6> rgb 0.6 shadowless }
light_source { <3, 5, 2> * 1000 rgb 0.3 parallel point_at 0 shadowless }
Eye(<0, 4, 11>, <0, 1, 0>, 40)
