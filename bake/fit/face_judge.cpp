#include "bake/fit/face_judge.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bake/sampling/directions.h"
#include "sh/models.h"

namespace apertura {
namespace {

constexpr int kLights = 24;    // over the hemisphere,
constexpr double kRadius = 5;  // degrees

Receiver receiver(const Visibility& v, const glm::vec3& normal) { return toReceiver(models()[MODEL_SOFT], clampToPossible(v), normal); }

double value(const Receiver& r, const CapLight& light) { return irradianceThrough(MODEL_SOFT, r, light, LIGHTS_MEDIUM) / light.area; }

}  // namespace

Judge::Judge() : lights_(fibonacciHemisphere(kLights)) {}

SquaredErrors Judge::at(const Probe& witness, const Receiver& fitted, const glm::vec3& normal, double spin) const {
    const glm::mat3 frame = frameFromZ(normal, spin);
    const Receiver a = receiver(witness.halves[0], normal), b = receiver(witness.halves[1], normal),
                   both = receiver(witness.mean(), normal);
    double sum = 0;
    for (const glm::vec3& l : lights_) {
        const CapLight light = capLight(frame * l, float(std::sin(kRadius * std::numbers::pi / 180)));
        // Few rays make the aperture of a small opening sharper than it is, and twice as many half as much too sharp: each half is
        // replaced by what it would add to the light if light were linear in visibility.
        const double e = value(fitted, light), whole = 2 * value(both, light);
        sum += (whole - value(b, light) - e) * (whole - value(a, light) - e);
    }
    const auto sky = [&](const Receiver& r) { return std::max(glm::dot(glm::vec3(r.visibility), normal), 0.0f) / std::numbers::pi; };
    return {sum / kLights, (sky(a) - sky(fitted)) * (sky(b) - sky(fitted))};
}

double Judge::spread(const std::array<Receiver, 3>& samples, const glm::vec3& shares, const glm::vec3& normal, double spin) const {
    const glm::mat3 frame = frameFromZ(normal, spin);
    double sum = 0;
    for (const glm::vec3& l : lights_) {
        const CapLight light = capLight(frame * l, float(std::sin(kRadius * std::numbers::pi / 180)));
        glm::vec3 e(0);
        for (int c = 0; c < 3; ++c) e[c] = irradianceThrough(MODEL_APERTURE, samples[size_t(c)], light, LIGHTS_MEDIUM) / light.area;
        const float mean = glm::dot(shares, e);
        sum += glm::dot(shares, (e - mean) * (e - mean));
    }
    return sum / kLights;
}

}  // namespace apertura
