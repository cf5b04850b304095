#include "common.inc"
object { Ball Glass(1e9, 1.5) translate <-1.5, 1, 0> }
object { Cube Glass(1e9, 1.33) scale <0.7, 0.9, 0.5> rotate 30 * y translate <1.3, 0.91, 0.6> }
difference { sphere { 0, 0.6 } sphere { 0, 0.5 } Glass(1e9, 1.65) translate <0, 0.61, 2> }
object { Ball Matte(srgb <0.8, 0.2, 0.2>, 0.8) scale 0.6 translate <-0.6, 0.6, -2> }
object { Horn Matte(srgb <0.3, 0.4, 0.9>, 0.8) scale <1.6, 0.7, 0.7> rotate -90 * z translate <1.8, 1.6, -2> }
object { Cube Matte(srgb <0.7, 0.7, 0.7>, 0.8) scale <6, 0.5, 6> translate <0, -0.5, 0> }
Eye(<0, 3, 9>, <0, 0.9, 0>, 45)
