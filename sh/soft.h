#pragma once
#include <span>

#include "apertura/sh/sh4.h"
#include "apertura/sh/shading.h"

namespace apertura {

// The soft aperture whose integrals over the hemisphere about `normal` (unit) are the A and D of `v`: it uses all four
// numbers.
// It is looked up in a table, millions of points a second on one core. E is within 0.003 RMS of the full solve
// (soft_solve.h) at those receivers of the built-in scenes that are open by 0.001..0.999 and have a slope below 1000.
// Harder edges are softened to the limit of the table.
AperturaSoftAperture toSoft(const Visibility& v, const vec3& normal);

// A lobe, slope and offset, no sharper than formulas can use: aperturaLimitSharpness of shaders/soft_table.glsl.
vec4 limitedLobe(const vec4& lobe);

// The table, for shaders that look it up themselves: APERTURA_SOFT_AREAS * APERTURA_SOFT_PSIS * APERTURA_SOFT_REACHES nodes
// (shaders/soft_grid.glsl).
std::span<const vec4> softNodes();

}  // namespace apertura
