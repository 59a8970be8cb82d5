#pragma once
#include <glm/glm.hpp>
#include <span>

namespace apertura {

// A spherical cap in double precision: {w : dot(w, axis) >= cos(radius)}.
struct ExactCap {
    glm::dvec3 axis;  // unit
    double radius;    // radians, 0..pi
};

// The vector irradiance F = integral of w over the intersection of `caps` (1 to 8 of them), in sr.
// For unit radiance E = dot(normal, F), provided that the horizon (normal, pi/2) is one of the caps. F is also the
// visible direction D of the region. It is half the boundary integral of w x dw (Stokes' theorem), summed arc by arc,
// with an error of about 1e-12. Slow: it is the truth in the tests of the shaders' formulas.
glm::dvec3 vectorIrradiance(std::span<const ExactCap> caps);

}  // namespace apertura
