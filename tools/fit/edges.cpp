// How far two edges coincide as a light sees them, and how soft a lobe's edge is beside a light: the mean of a product of two lobes.
// fits shaders/soft.glsl aperturaInverseDeviationOfLobe 3.2
// fits shaders/edges.glsl aperturaEdgeAlignment 0.64 0.36=1-0.64
// with sh/soft_solve.cpp
#include "light_integral.h"

using namespace apertura;
using namespace apertura::test;

namespace {

struct Case {
    dvec3 axis;
    double radius, both;
    vec4 lobes[2];
};

// Lights of 1 to 10 degrees above the horizon; half of the pairs are nearly parallel or antiparallel.
std::vector<Case> cases() {
    Random random(103);
    std::vector<Case> out;
    for (int i = 0; i < 3000; ++i) {
        Case c{{}, std::pow(10.0, random()) * pi / 180, 0, {}};
        const double z = random(std::sin(c.radius), 1);
        c.axis = dvec3(std::sqrt(1 - z * z), 0, z);
        for (vec4& lobe : c.lobes) lobe = lobeAcross(random, c.axis, c.radius, 3 * std::pow(80, random()));
        if (i % 2) {
            const vec3 near = normalize((random() < 0.5 ? 1.0f : -1.0f) * normalize(vec3(c.lobes[0])) + 0.3f * vec3(random.direction()));
            const float length0 = length(vec3(c.lobes[1])), was = c.lobes[1].w + dot(vec3(c.lobes[1]), vec3(c.axis));
            c.lobes[1] = vec4(length0 * near, was - length0 * dot(near, vec3(c.axis)));
        }
        for (const Weighted& w : lightDirections(c.axis, c.radius))
            c.both += w.weight * stepAt(c.lobes[0], w.direction) * stepAt(c.lobes[1], w.direction);
        out.push_back(c);
    }
    return out;
}

}  // namespace

double error() {
    static const std::vector<Case> all = cases();
    const vec3 normal(0, 0, 1);
    double sum = 0;
    for (const Case& c : all) {
        AperturaReceiver receiver{normal, vec4(float(pi) * normal, float(2 * pi)), {}};
        receiver.params[0] = c.lobes[0], receiver.params[1] = c.lobes[1];
        const AperturaCapLight light = apertura::test::aperturaCapLight(c.axis, c.radius);
        const int lightClass = APERTURA_LIGHTS_MEDIUM;
        sum += std::pow(aperturaIrradianceThrough(APERTURA_MODEL_FIRM_2, receiver, light, lightClass)
                                / aperturaUnoccludedIrradiance(normal, light, lightClass)
                            - c.both,
                        2);
    }
    return std::sqrt(sum / double(all.size()));
}
