#include "apertura/bake/sampling/probes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apertura/bake/sampling/directions.h"
#include "apertura/runtime/asset/faces.h"

namespace apertura {
namespace {

constexpr int kFewest = 8, kFewestToJudge = 128, kMostToJudge = 256;  // rays of probes, and of witnesses
constexpr int kBuried = Solids::kProbes / 4;

// A sequence that fills the unit square evenly, however long it is: Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences",
// 2018.
glm::dvec2 evenly(size_t k, const glm::dvec2& start) {
    return {std::fmod(start.x + 0.7548776662466927 * double(k), 1.0), std::fmod(start.y + 0.5698402909980532 * double(k), 1.0)};
}

}  // namespace

Prober::Prober(const Scene& scene, const OcclusionSource& source, const Solids& solids, int rays, uint32_t seed)
    : scene_(scene),
      source_(source),
      solids_(solids),
      seed_(seed),
      few_(fibonacciHemisphere(std::max(rays / 2, kFewest) & ~1)),
      many_(fibonacciHemisphere(std::clamp(rays, kFewestToJudge, kMostToJudge) & ~1)),
      witnessesASample_(std::max(1.0, double(rays) / double(many_.size()))) {}

SurfacePoint Prober::pointAt(size_t instance, size_t triangle, const glm::vec3& weights) const {
    const SurfaceAt at = surfaceAt(scene_, int(instance), int(triangle), weights);
    return {at.position, at.looking(), at.longest};
}

Probe Prober::look(size_t instance, size_t triangle, size_t k, const std::vector<glm::vec3>& among) const {
    const uint64_t place = uint64_t(instance) << 32 | triangle;
    const uint64_t first = 31 + 1000003ull * among.size();  // of the hashes, apart from those of the other kind of points
    glm::dvec2 p = evenly(k, {hashUnit(seed_, place, first), hashUnit(seed_, place, first + 1)});
    if (p.x + p.y > 1) p = 1.0 - p;
    const glm::vec3 weights(1 - p.x - p.y, p.x, p.y);
    const SurfacePoint point = pointAt(instance, triangle, weights);
    Probe out{weights, {}, glm::vec3(0), point.normal, false};
    const double spin = 2 * std::numbers::pi * hashUnit(seed_, place, first + 2 + k);
    const glm::mat3 frame = frameFromZ(point.normal, spin);
    const size_t rays = among.size();
    std::vector<glm::vec3> directions(rays);
    std::vector<uint8_t> blocked(rays);
    for (size_t i = 0; i < rays; ++i) directions[i] = frame * among[i];
    source_.occluded(point, directions, blocked.data());
    rays_ += rays;
    size_t open = 0;
    for (size_t half = 0; half < 2; ++half) {
        // Neighbours in the list are neighbours on the sphere: every second one covers all of it. What a half of the directions sums to
        // is not quite what they stand for: an open hemisphere is made exactly open.
        glm::vec3 all(0), seen(0), allBent(0), seenBent(0);
        size_t count = 0;
        for (size_t i = half; i < rays; i += 2) {
            const glm::vec3 slanted = among[i].z * directions[i];
            all += directions[i], allBent += slanted;
            if (blocked[i]) continue;
            seen += directions[i], seenBent += slanted;
            ++count;
        }
        open += count;
        constexpr auto pi = float(std::numbers::pi);
        const float share = float(count) / float(rays / 2), each = 2 * pi / float(rays / 2);
        out.halves[half] = {each * (seen - share * all) + share * pi * point.normal, share * 2 * pi};
        out.bent += 0.5f * (each * (seenBent - share * allBent) + share * (2 * pi / 3) * point.normal);
    }
    if (2 * open <= rays) {
        out.buried = solids_.backsSeen(point, spin) > kBuried;
        rays_ += Solids::kProbes;
    }
    return out;
}

}  // namespace apertura
