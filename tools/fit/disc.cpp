// The mean of a soft step over a light's disc, as a line: why `soft` leans by 0.5032.
// fits shaders/soft.glsl aperturaWholeDisc 0.49846 0.46693 0.13564 0.41078
// fits shaders/soft.glsl aperturaSoftDisc 0.64280 0.93650
// links fit
// links scene
// links sampling
// links directions
// links asset
// links measure
// links sh
#include "scene_lights.h"

using namespace apertura;
using namespace apertura::test;

namespace {

struct Case {
    dvec3 axis;
    double radius, open, mean;  // open: E / (pi sin^2 r) without the lobe
    vec4 lobe;
};

// Lights of 1 to 45 degrees from a little below the horizon up, edges of any softness that lie across them or near.
std::vector<Case> cases() {
    Random random(105);
    std::vector<Case> out;
    for (int i = 0; i < 3000; ++i) {
        Case c{{}, 1 * std::pow(45.0, random()) * pi / 180, 0, 0, {}};
        const double z = random(-0.5 * std::sin(c.radius), 1);
        c.axis = dvec3(std::sqrt(1 - z * z), 0, z);
        c.lobe = lobeAcross(random, c.axis, c.radius, std::pow(240, random()));
        c.open = exactFraction({0, 0, 1}, {{c.axis, c.radius}}, c.radius);
        for (const Weighted& w : lightDirections(c.axis, c.radius)) c.mean += w.weight * stepAt(c.lobe, w.direction);
        out.push_back(c);
    }
    return out;
}

double meanOver(const vec4& lobe, const AperturaCapLight& light) {
    return aperturaSoftStepOverLight(vec3(0, 0, 1), lobe.w + dot(vec3(lobe), light.axis), vec3(lobe), light, aperturaSoftDisc());
}

}  // namespace

double error() {
    static const std::vector<Case> all = cases();
    double sum = 0;
    for (const Case& c : all) sum += std::pow(c.open * (meanOver(c.lobe, apertura::test::aperturaCapLight(c.axis, c.radius)) - c.mean), 2);
    // As sharp as it may be: with openings that a large light covers whole, 2 % further than the bound.
    static const std::vector<SceneReceiver> inScenes = sceneReceivers(models()[APERTURA_MODEL_SOFT], 12);
    const double steps = steepestInScenes(inScenes, APERTURA_MODEL_SOFT, APERTURA_LIGHTS_ANY, {15, 30});
    return std::sqrt(sum / double(all.size())) + 3 * std::max(steps - 1.019, 0.0);
}
