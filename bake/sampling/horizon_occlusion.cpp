#include "apertura/bake/sampling/horizon_occlusion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace apertura {
namespace {

constexpr float kScale = 32767;

}  // namespace

HorizonOcclusion::HorizonOcclusion(const HeightField& field, int azimuths, const HorizonOptions& options, const Progress& progress)
    : width_(field.width),
      height_(field.height),
      azimuths_(azimuths),
      spacingX_(field.spacingX),
      spacingZ_(field.spacingZ),
      heights_(field.texels() * size_t(azimuths)) {
    std::vector<double> all;
    for (int k = 0; k < azimuths; ++k) all.push_back(2 * std::numbers::pi * k / azimuths);
    const auto keep = [&](size_t k, int, std::span<const float> tangents) {
        for (size_t i = 0; i < tangents.size(); ++i) {
            const float t = tangents[i], sine = std::isfinite(t) ? t / std::sqrt(1 + t * t) : -1;
            heights_[i * size_t(azimuths) + k] = int16_t(std::lround(kScale * sine));
        }
    };
    findHorizons(field, all, options, keep, progress);
}

void HorizonOcclusion::occluded(const SurfacePoint& point, std::span<const glm::vec3> directions, uint8_t* blocked) const {
    const auto nearest = [](double at, double spacing, int count) {
        return std::clamp(int(std::lround(at / spacing + 0.5 * (count - 1))), 0, count - 1);
    };
    const size_t texel = size_t(nearest(point.position.z, spacingZ_, height_)) * size_t(width_)
                       + size_t(nearest(point.position.x, spacingX_, width_));
    const int16_t* const horizons = &heights_[texel * size_t(azimuths_)];
    const auto perRadian = float(azimuths_ / (2 * std::numbers::pi));
    for (size_t i = 0; i < directions.size(); ++i) {
        const glm::vec3& d = directions[i];
        float at = std::atan2(d.x, -d.z) * perRadian;  // from north by east
        if (at < 0) at += float(azimuths_);
        const int k = int(at) % azimuths_, next = (k + 1) % azimuths_;
        const float weight = at - std::floor(at), sine = float(horizons[k]) + weight * float(horizons[next] - horizons[k]);
        blocked[i] = kScale * d.y < sine;
    }
}

}  // namespace apertura
