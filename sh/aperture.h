#pragma once
#include "apertura/sh/sh4.h"
#include "apertura/sh/shading.h"

namespace apertura {

// The spherical cap with the visible area of `v` about its mean direction. Exact when the open region is a cap; the
// fourth number, |D|, is not used.
//   normal  unit; it is the axis where |D| is at most 0.001 A: nothing is open, or all sides are open alike
AperturaAperture toAperture(const Visibility& v, const vec3& normal);

}  // namespace apertura
