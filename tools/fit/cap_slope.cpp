// The slope that stands for a cap's hard edge, where its visibility is multiplied with another's.
// fits shaders/visible.glsl APERTURA_CAP_SLOPE 240.0
// with sh/soft_solve.cpp
// reason: the harder the better; 240 is as hard as lobes may be, whose squares 16-bit floats hold.
#include "light_integral.h"

using namespace apertura;
using namespace apertura::test;

namespace {

struct Case {
    dvec3 axis, cap;
    double radius, capRadius, both;
    vec4 lobe;
};

// A cap whose edge crosses a light of 0.5 to 9 degrees, and a hard lobe whose edge does too, one in two nearly the same edge.
std::vector<Case> cases() {
    Random random(104);
    std::vector<Case> out;
    for (int i = 0; i < 3000; ++i) {
        Case c{};
        c.radius = 0.5 * std::pow(18.0, random()) * pi / 180;
        c.axis = normalize(dvec3(random(-0.3, 0.3), random(-0.3, 0.3), 1));
        c.capRadius = random(0.3, 1.4);
        const dvec3 side = normalize(cross(c.axis, random.direction()));
        const double away = c.capRadius + random(-0.9, 0.9) * c.radius;
        c.cap = std::cos(away) * c.axis + std::sin(away) * side;
        const dvec3 slope = 60.0
                          * (i % 2 ? normalize((random() < 0.5 ? 1.0 : -1.0) * side + 0.3 * random.direction()) : random.direction());
        c.lobe = vec4(vec3(slope), float(60 * std::sin(c.radius) * random(-1, 1) - dot(slope, c.axis)));
        for (const Weighted& w : lightDirections(c.axis, c.radius, 32, 64))
            c.both += w.weight * (dot(w.direction, c.cap) >= std::cos(c.capRadius)) * stepAt(c.lobe, w.direction);
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
        const AperturaCapLight light = apertura::test::aperturaCapLight(c.axis, c.radius);
        AperturaReceiver receiver{normal, vec4(float(pi) * normal, float(2 * pi)), {}};
        AperturaReceiver cap = aperturaWithAperture(receiver, capAperture(c.cap, c.capRadius), 1);
        receiver.params[0] = c.lobe;
        const int lightClass = APERTURA_LIGHTS_MEDIUM;
        const AperturaLightVisibility a = aperturaVisibilityOfLight(APERTURA_MODEL_APERTURE, cap, light, lightClass);
        const AperturaLightVisibility b = aperturaVisibilityOfLight(APERTURA_MODEL_SOFT, receiver, light, lightClass);
        sum += std::pow(aperturaMeanOfBoth(a, b, light) - c.both, 2);
    }
    return std::sqrt(sum / double(all.size()));
}
