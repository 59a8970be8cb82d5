// The line that stands for a quarter of a large light, for a step that follows a quadric.
// fits shaders/soft.glsl aperturaQuadricQuarter 0.6952 0.6296
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
    double radius, open, mean;
    AperturaReceiver receiver;
};

// What soft-l2 fits: slopes of up to 30, bends as large.
AperturaReceiver quadric(Random& random, const dvec3& through) {
    const double size = std::pow(30, random());
    const dvec3 slope = size * random.direction();
    AperturaSoftQuadric q{vec3(slope), 0, vec4(0), 0};
    for (int i = 0; i < 4; ++i) q.bend[i] = float(random(-0.7, 0.7) * size);
    q.bendYz = float(random(-0.7, 0.7) * size);
    q.offset = float(-dot(slope, through) - dot(vec3(through), aperturaBendTimes(q, vec3(through))) + random(-1, 1) * (1 + 0.3 * size));
    return aperturaWithQuadric({vec3(0, 0, 1), vec4(0, 0, float(pi), float(2 * pi)), {}}, q);
}

double exponentAt(const AperturaReceiver& receiver, const dvec3& w) {
    const AperturaSoftQuadric q = aperturaQuadricIn(receiver);
    return q.offset + dot(q.slope, vec3(w)) + dot(vec3(w), aperturaBendTimes(q, vec3(w)));
}

std::vector<Case> cases() {
    Random random(112);
    std::vector<Case> out;
    for (int i = 0; i < 2000; ++i) {
        Case c{{}, 10 * std::pow(4.5, random()) * pi / 180, 0, 0, {}};
        const double z = random(-0.5 * std::sin(c.radius), 1);
        c.axis = dvec3(std::sqrt(1 - z * z), 0, z);
        c.receiver = quadric(random, c.axis);
        c.open = exactFraction({0, 0, 1}, {{c.axis, c.radius}}, c.radius);
        for (const Weighted& w : lightDirections(c.axis, c.radius)) c.mean += w.weight * softStepExact(exponentAt(c.receiver, w.direction));
        out.push_back(c);
    }
    return out;
}

}  // namespace

double error() {
    static const std::vector<Case> all = cases();
    static const std::vector<SceneReceiver> inScenes = sceneReceivers(models()[APERTURA_MODEL_SOFT_L2]);
    double sum = 0;
    for (const Case& c : all) {
        const AperturaCapLight light = test::aperturaCapLight(c.axis, c.radius);
        const float e = aperturaIrradianceThrough(APERTURA_MODEL_SOFT_L2, c.receiver, light, APERTURA_LIGHTS_ANY);
        sum += std::pow(normalised(e, c.radius) - c.open * c.mean, 2);
    }
    const double steps = steepestInScenes(inScenes, APERTURA_MODEL_SOFT_L2, APERTURA_LIGHTS_ANY, {15, 30});
    return std::sqrt(sum / double(all.size())) + 3 * std::max(steps - 1, 0.0);
}
