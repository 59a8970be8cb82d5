#pragma once
#include "sh/sh4.h"
#include "sh/shading.h"

namespace apertura {

// The aperture with the visible area and mean direction of `v`. Exact when the open region is a cap;
// otherwise the axis is the region's centroid and the fourth number, |D|, is not used.
// Closed, or open alike all around: the axis is `normal` (unit).
Aperture toAperture(const Visibility& v, const vec3& normal);

}  // namespace apertura
