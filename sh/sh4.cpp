#include "apertura/sh/sh4.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace apertura {
namespace {

constexpr double kPi = std::numbers::pi;
const double kBand0 = 0.5 / std::sqrt(kPi);
const double kBand1 = std::sqrt(3 / (4 * kPi));

float largestDirection(float area) { return area * (1 - area / float(4 * kPi)); }

}  // namespace

Sh4 shBasis(const glm::vec3& w) { return {{float(kBand0), float(kBand1 * w.y), float(kBand1 * w.z), float(kBand1 * w.x)}}; }

Sh4 project(std::span<const glm::vec3> open, double solidAngle) {
    double sum[4]{};
    for (const glm::vec3& w : open) {
        const Sh4 y = shBasis(w);
        for (int i = 0; i < 4; ++i) sum[i] += y.c[i];
    }
    Sh4 out;
    for (int i = 0; i < 4; ++i) out.c[i] = float(sum[i] * solidAngle);
    return out;
}

Sh4 toSh4(const Visibility& v) {
    return {{float(v.area * kBand0), float(v.direction.y * kBand1), float(v.direction.z * kBand1), float(v.direction.x * kBand1)}};
}

Visibility toVisibility(const Sh4& sh) {
    return {{float(sh.c[3] / kBand1), float(sh.c[1] / kBand1), float(sh.c[2] / kBand1)}, float(sh.c[0] / kBand0)};
}

float capness(const Visibility& v) {
    if (!(v.area > 0)) return 1;
    return std::min(glm::length(v.direction) / largestDirection(v.area), 1.0f);
}

Visibility clampToPossible(Visibility v) {
    const float length = glm::length(v.direction);
    if (!(v.area > 0) || !std::isfinite(v.area) || !std::isfinite(length)) return {};
    v.area = std::min(v.area, float(2 * kPi));
    const float bound = largestDirection(v.area);
    if (length > bound) v.direction *= bound / length;
    return v;
}

}  // namespace apertura
