// How much of a light the horizon leaves: the rim of lights of up to 45 degrees and its slope.
// fits shaders/cap.glsl aperturaRimOf 0.45902 0.06219 0.07244 1.12786 0.23844 0.01434
// with sh/cap_reference.cpp
#include "fitted.h"

using namespace apertura;
using namespace apertura::test;

namespace {

struct Case {
    dvec3 axis;
    double radius, exact;
};

// Lights that the horizon cuts, and as many just above and below it.
std::vector<Case> cases() {
    std::vector<Case> out;
    for (double degrees = 1; degrees <= 45; degrees += 1)
        for (double at = -1.5; at <= 1.5; at += 0.02) {
            const double radius = degrees * pi / 180, z = at * std::sin(radius);
            if (std::abs(z) > 1) continue;
            const dvec3 axis(std::sqrt(1 - z * z), 0, z);
            out.push_back({axis, radius, exactFraction({0, 0, 1}, {{axis, radius}}, radius)});
        }
    return out;
}

}  // namespace

double error() {
    static const std::vector<Case> all = cases();
    double sum = 0, most = 0;
    for (const Case& c : all) {
        const double e = aperturaIrradianceAboveHorizon(vec3(0, 0, 1), apertura::test::aperturaCapLight(c.axis, c.radius));
        sum += std::pow(normalised(e, c.radius) - c.exact, 2);
        most = std::max(most, std::abs(normalised(e, c.radius) - c.exact));
    }
    // Within a thousandth everywhere. Larger lights, which overlaps may be as well, bring no more than 0.6 % too much.
    double excess = 0;
    for (double degrees = 45; degrees <= 90; degrees += 5)
        for (int i = -50; i <= 50; ++i) {
            const double z = i / 50.0;
            const double radius = degrees * pi / 180;
            const AperturaCapLight light = apertura::test::aperturaCapLight(dvec3(std::sqrt(1 - z * z), 0, z), radius);
            excess = std::max(excess, normalised(aperturaIrradianceAboveHorizon(vec3(0, 0, 1), light), radius) - 1.0055);
        }
    return std::sqrt(sum / double(all.size())) + excess + std::max(most - 0.00095, 0.0);
}
