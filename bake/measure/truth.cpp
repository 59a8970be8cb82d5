#include "apertura/bake/measure/truth.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/scene/builtin.h"

namespace apertura {
namespace {

using std::numbers::pi;

}  // namespace

MeasuredRegion measuredRegion(const std::string& name, const Scene& scene) {
    const std::optional<BuiltinScene> builtin = findBuiltin(name);
    if (!builtin || builtin->receives.size() != scene.surfaces.size()) return {};
    return {{builtin->receives, builtin->receiverBoxes}, builtin->skyAboveGround};
}

std::vector<SurfaceSample> sampleReceivers(const Scene& scene, int count, uint32_t seed) {
    return sampleSurface(scene, count, seed, measuredRegion(scene.name, scene).region);
}

std::vector<glm::vec3> lightDirections(const MeasuredRegion& region, const SurfacePoint& receiver, uint32_t seed, size_t index) {
    const glm::vec3 up = region.skyAboveGround ? glm::vec3(0, 1, 0) : receiver.normal;
    const glm::mat3 frame = frameFromZ(up, 2 * pi * hashUnit(seed, index, 21));
    std::vector<glm::vec3> out;
    for (const glm::vec3& w : fibonacciHemisphere(80)) out.push_back(frame * w);
    for (double elevation : {3.0, 8.0})
        for (int i = 0; i < 8; ++i) {
            const double turn = 2 * pi * i / 8 + elevation, e = elevation * pi / 180;
            out.push_back(frame * glm::vec3(std::cos(e) * std::cos(turn), std::cos(e) * std::sin(turn), std::sin(e)));
        }
    return out;
}

TruthSample traceLight(const Tracer& tracer, const SurfacePoint& receiver, const glm::vec3& direction, double radius, int samples,
                       double spin) {
    const double height = 2 * std::sin(radius / 2) * std::sin(radius / 2);
    const glm::mat3 frame = frameFromZ(direction, spin);
    std::vector<glm::vec3> rays;
    for (const glm::vec3& w : fibonacciCap(samples, height)) rays.push_back(frame * w);
    std::vector<uint8_t> blocked(rays.size());
    tracer.occluded(rayOrigin(tracer, receiver, kTruthOffset), rays, kNoLimit, blocked.data());
    double sum[2]{};
    for (size_t i = 0; i < rays.size(); ++i)
        if (!blocked[i]) sum[i & 1] += std::max(glm::dot(rays[i], receiver.normal), 0.0f);
    // The cap's solid angle 2 pi h over pi sin^2 r, for each half of samples / 2 rays.
    const double scale = 2 * height / (std::sin(radius) * std::sin(radius)) / (samples / 2.0);
    return {float(sum[0] * scale), float(sum[1] * scale)};
}

}  // namespace apertura
