#pragma once
// Singular configurations of one opening and one light, frame by frame.
#include <glm/glm.hpp>
#include <string_view>
#include <vector>

namespace apertura {

// A direction `angle` radians from +Z, towards +X turned by `turn` radians.
glm::dvec3 tilted(double angle, double turn = 0);

// `axis` moved by `angle` radians along the great circle that leaves it at right angles to +Y, towards +X from +Z.
glm::dvec3 away(const glm::dvec3& axis, double angle);

// One cap light over one cap-shaped opening; the receiver's normal is +Z.
struct SweepFrame {
    glm::dvec3 aperture;    // unit
    double apertureRadius;  // radians, 0 .. pi
    glm::dvec3 light;       // unit
    double lightRadius;     // radians, 0 .. pi / 2
    double moved = 0;       // radians that the light moved since the frame before
    double axisLength = 1;  // of the aperture's axis as it is stored
    double areaScale = 1;   // of its area
};

struct Sweep {
    std::string_view name;
    std::string_view what;
    std::vector<SweepFrame> frames;
};

// All singular configurations, by name.
std::vector<Sweep> singularSweeps();

}  // namespace apertura
