#pragma once
// Singular configurations of one opening and one light, as sequences of frames.
#include <glm/glm.hpp>
#include <string_view>
#include <vector>

namespace apertura {

// A direction `angle` radians from +Z, towards +X turned by `turn` radians.
glm::dvec3 tilted(double angle, double turn = 0);

// `axis` turned by `angle` radians along the great circle through it that starts in the direction cross(+Y, axis).
glm::dvec3 away(const glm::dvec3& axis, double angle);

// One cap light over one cap-shaped opening; the receiver's normal is +Z.
struct SweepFrame {
    glm::dvec3 aperture;    // unit
    double apertureRadius;  // radians, 0 .. pi
    glm::dvec3 light;       // unit
    double lightRadius;     // radians, 0 .. pi / 2
    double moved = 0;       // radians that the light moved since the last frame; 0 if anything else changed too
    double axisLength = 1;  // length of the stored axis, as interpolation or rounding changes it
    double areaScale = 1;   // the stored area as a multiple of the cap's own
};

struct Sweep {
    std::string_view name;
    std::string_view what;  // one line for a reader
    std::vector<SweepFrame> frames;
};

// All singular configurations, by name.
std::vector<Sweep> singularSweeps();

}  // namespace apertura
