// The mean of a soft step over a small or medium light by one root.
// fits shaders/cap.glsl aperturaCapLight 0.5449 0.5769
// with sh/soft_solve.cpp
// with sh/cap_reference.cpp
#include "light_integral.h"

using namespace apertura;
using namespace apertura::test;

namespace {

struct Case {
    dvec3 axis;
    double radius, open, mean;
    vec4 lobe;
};

std::vector<Case> cases() {
    Random random(108);
    std::vector<Case> out;
    for (int i = 0; i < 3000; ++i) {
        Case c{{}, 0.6 * std::pow(10 / 0.6, random()) * pi / 180, 0, 0, {}};
        const double z = random(-0.5 * std::sin(c.radius), 1);
        c.axis = dvec3(std::sqrt(1 - z * z), 0, z);
        c.lobe = lobeAcross(random, c.axis, c.radius, std::pow(240, random()));
        c.open = exactFraction({0, 0, 1}, {{c.axis, c.radius}}, c.radius);
        for (const Weighted& w : lightDirections(c.axis, c.radius)) c.mean += w.weight * stepAt(c.lobe, w.direction);
        out.push_back(c);
    }
    return out;
}

double steepestOfAll() {
    static const std::vector<dvec3> slopes = [] {
        Random random(109);
        std::vector<dvec3> made(150);
        for (dvec3& slope : made) slope = 240.0 * random.direction();
        return made;
    }();
    return steepest(int(slopes.size()), {0.02, 0.06, 0.17}, [](int i, const AperturaCapLight& light) {
        const vec3 slope(slopes[size_t(i)]);
        return aperturaIrradianceThroughSoft(vec3(0, 0, 1), {slope, 0.2f * slope.x}, light, APERTURA_LIGHTS_MEDIUM);
    });
}

}  // namespace

double error() {
    static const std::vector<Case> all = cases();
    double sum = 0;
    for (const Case& c : all)
        sum += std::pow(c.open * (aperturaLobeOverMedium({vec3(c.lobe), c.lobe.w}, test::aperturaCapLight(c.axis, c.radius)) - c.mean), 2);
    // As sharp as it may be.
    return std::sqrt(sum / double(all.size())) + 3 * std::max(steepestOfAll() - 1, 0.0);
}
