// The law of a light's overlap with an aperture, and the angles that it is a function of.
// fits shaders/cap.glsl aperturaPseudoAngleOverRoot 1.4038 0.2180
// fits shaders/aperture.glsl aperturaOverlapOf 0.2904 0.1778 0.5603 0.6492 0.1474
// links fit
// links scene
// links measure
// links sampling
// links directions
// links asset
// links sh
#include "apertura/bake/measure/sweeps.h"
#include "scene_lights.h"

using namespace apertura;
using namespace apertura::test;

namespace {

const dvec3 kNormal(0, 0, 1);

double lightThrough(const dvec3& axis, double apertureRadius, const dvec3& towards, double lightRadius,
                    int lightClass = APERTURA_LIGHTS_ANY) {
    const AperturaCapLight light = apertura::test::aperturaCapLight(towards, lightRadius);
    return normalised(aperturaIrradianceThroughAperture(vec3(kNormal), capAperture(axis, apertureRadius), light, lightClass), lightRadius);
}

struct Case {
    dvec3 axis, light;
    double apertureRadius, lightRadius, exact;
};

// Apertures of the upper hemisphere of any area, lights of 0.27 to 45 degrees, half of them on the aperture's rim.
std::vector<Case> cases() {
    Random random(101);
    std::vector<Case> out;
    while (out.size() < 150000) {
        dvec3 axis = random.direction(), light = random.direction();
        axis.z = std::abs(axis.z);
        const double r0 = std::acos(1 - random()), r1 = 0.27 * std::pow(45 / 0.27, random()) * pi / 180;
        if (out.size() % 2) {
            const double d = r0 + r1 * random(-2, 2);
            light = std::cos(d) * axis + std::sin(d) * normalize(cross(axis, random.direction()));
        }
        if (light.z < -std::sin(r1)) continue;
        out.push_back({axis, light, r0, r1, exactFraction(kNormal, {{axis, r0}, {light, r1}}, r1)});
    }
    return out;
}

// The singular configurations of `apertura stability`: errors there are a share of the smaller of light and aperture.
double worstOfSweeps() {
    static const std::vector<Case> all = [] {
        std::vector<Case> out;
        for (const Sweep& sweep : singularSweeps())
            for (const SweepFrame& f : sweep.frames) {
                if (f.areaScale != 1 || f.axisLength != 1 || f.lightRadius > pi / 4 || f.apertureRadius < 1e-3) continue;
                const double exact = exactFraction(kNormal, {{f.aperture, f.apertureRadius}, {f.light, f.lightRadius}}, f.lightRadius);
                out.push_back({f.aperture, f.light, f.apertureRadius, f.lightRadius, exact});
            }
        return out;
    }();
    double worst = 0;
    for (const Case& c : all) {
        const double e = lightThrough(c.axis, c.apertureRadius, c.light, c.lightRadius, lightClassOf(float(std::sin(c.lightRadius))))
                       - c.exact;
        worst = std::max(worst, std::abs(e) * std::pow(std::sin(c.lightRadius) / std::sin(std::min(c.lightRadius, c.apertureRadius)), 2));
    }
    return worst;
}

// The largest step of a light that moves across an aperture, as a share of what a moving light can at most change: 2 / (pi sin r) a radian.
double steepest() {
    double out = 0;
    for (const double apertureRadius : {0.05, 0.1, 0.2, 0.35, 0.6, 0.9, 1.2, 1.5})
        for (const double lightRadius : {0.005, 0.05, 0.1, 0.25, 0.5, 0.78}) {
            const double step = 0.02 * std::min(apertureRadius, lightRadius);
            double before = -1;
            for (double d = std::max(apertureRadius - lightRadius - 0.02, 0.0); d < apertureRadius + lightRadius; d += step) {
                const double now = lightThrough({std::sin(d), 0, std::cos(d)}, apertureRadius, kNormal, lightRadius);
                if (before >= 0) out = std::max(out, std::abs(now - before) / step * pi * std::sin(lightRadius) / 2);
                before = now;
            }
        }
    return out;
}

}  // namespace

double error() {
    static const std::vector<Case> all = cases();
    double sum = 0, most = 0;
    int count = 0;
    const auto add = [&](const Case& c, int lightClass) {
        const double e = std::abs(lightThrough(c.axis, c.apertureRadius, c.light, c.lightRadius, lightClass) - c.exact);
        sum += e * e;
        most = std::max(most, e);
        ++count;
    };
    // With every formula that a light of this size may be drawn with.
    for (const Case& c : all) {
        add(c, APERTURA_LIGHTS_ANY);
        if (const int own = lightClassOf(float(std::sin(c.lightRadius))); own != APERTURA_LIGHTS_ANY)
            add(c, std::min(own, APERTURA_LIGHTS_SMALL));
    }
    // With bounds below those that tests hold, since these cases are fewer: on the largest error (Aperture.LightThroughItIs...), in
    // singular configurations and on steps there (Stability.AperturesKeepTo...), and on the steps of two caps in the built-in scenes.
    static const std::vector<SceneReceiver> inScenes = sceneReceivers(models()[APERTURA_MODEL_MULTI_2]);
    const double ofTwo = steepestInScenes(inScenes, APERTURA_MODEL_MULTI_2, APERTURA_LIGHTS_ANY, {30}), sweeps = worstOfSweeps();
    return std::sqrt(sum / count) + std::max(most - 0.027, 0.0) + std::max(sweeps - 0.0151, 0.0) + std::max(steepest() - 1.027, 0.0)
         + std::max(ofTwo - 1.199, 0.0);
}
