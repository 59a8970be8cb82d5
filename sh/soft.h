#pragma once
#include "sh/sh4.h"
#include "sh/shading.h"

namespace apertura {

// The soft aperture whose hemisphere integrals about `normal` (unit) are A and D of `v`: all four
// numbers are used. From a table; E is within 0.003 RMS of the full solve (soft_solve.h), and the
// sharpest edges are a little softened. Millions of points a second on one core.
SoftAperture toSoft(const Visibility& v, const vec3& normal);

}  // namespace apertura
