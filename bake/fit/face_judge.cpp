#include "apertura/bake/fit/face_judge.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apertura/bake/sampling/directions.h"
#include "apertura/sh/models.h"

namespace apertura {
namespace {

constexpr int kLights = 24;    // over the hemisphere,
constexpr double kRadius = 5;  // degrees

AperturaReceiver receiver(const Visibility& v, const glm::vec3& normal) {
    return toReceiver(models()[APERTURA_MODEL_SOFT], clampToPossible(v), normal);
}

double value(const AperturaReceiver& r, const AperturaCapLight& light) {
    return aperturaIrradianceThrough(APERTURA_MODEL_SOFT, r, light, APERTURA_LIGHTS_MEDIUM) / light.area;
}

}  // namespace

Judge::Judge() : lights_(fibonacciHemisphere(kLights)) {}

SquaredErrors Judge::at(const Probe& witness, const AperturaReceiver& fitted, const glm::vec3& normal, double spin) const {
    const glm::mat3 frame = frameFromZ(normal, spin);
    const AperturaReceiver a = receiver(witness.halves[0], normal), b = receiver(witness.halves[1], normal),
                           both = receiver(witness.mean(), normal);
    double sum = 0;
    for (const glm::vec3& l : lights_) {
        const AperturaCapLight light = aperturaCapLight(frame * l, float(std::sin(kRadius * std::numbers::pi / 180)));
        // Few rays make the aperture of a small opening sharper than it is, and twice as many half as much too sharp: each half is
        // replaced by what it would add to the light if light were linear in visibility.
        const double e = value(fitted, light), whole = 2 * value(both, light);
        sum += (whole - value(b, light) - e) * (whole - value(a, light) - e);
    }
    const auto sky = [&](const AperturaReceiver& r) {
        return std::max(glm::dot(glm::vec3(r.visibility), normal), 0.0f) / std::numbers::pi;
    };
    return {sum / kLights, (sky(a) - sky(fitted)) * (sky(b) - sky(fitted))};
}

double Judge::spread(const std::array<AperturaReceiver, 3>& samples, const glm::vec3& shares, const glm::vec3& normal, double spin) const {
    const glm::mat3 frame = frameFromZ(normal, spin);
    double sum = 0;
    for (const glm::vec3& l : lights_) {
        const AperturaCapLight light = aperturaCapLight(frame * l, float(std::sin(kRadius * std::numbers::pi / 180)));
        glm::vec3 e(0);
        for (int c = 0; c < 3; ++c)
            e[c] = aperturaIrradianceThrough(APERTURA_MODEL_APERTURE, samples[size_t(c)], light, APERTURA_LIGHTS_MEDIUM) / light.area;
        const float mean = glm::dot(shares, e);
        sum += glm::dot(shares, (e - mean) * (e - mean));
    }
    return sum / kLights;
}

}  // namespace apertura
