#pragma once
#include "sh/sh4.h"
#include "sh/shading.h"

namespace apertura {

// The soft aperture whose hemisphere integrals about `normal` (unit) are A and D of `v`: all four
// numbers are used. From a table; E is within 0.003 RMS of the full solve (soft_solve.h) at the receivers of
// the built-in scenes that are open by 0.001..0.999 and have a slope below 1000. The sharpness of harder edges is limited. Millions of
// points a second on one core.
SoftAperture toSoft(const Visibility& v, const vec3& normal);

}  // namespace apertura
