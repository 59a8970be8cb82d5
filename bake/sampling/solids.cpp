#include "bake/sampling/solids.h"

#include <algorithm>
#include <array>
#include <map>

#include "bake/sampling/directions.h"

namespace apertura {
namespace {

// For each surface, the triangles with nothing behind them: those of two-sided materials, and those with a twin that
// faces the other way.
std::vector<std::vector<bool>> twoSided(const Scene& scene) {
    std::vector<std::vector<bool>> out;
    for (const Surface& surface : scene.surfaces) {
        std::vector<bool> open(surface.triangles.size(), surface.twoSided);
        using Place = std::array<float, 3>;
        // Key: sorted corners. Value: a triangle, and whether sorting reversed its winding.
        std::map<std::array<Place, 3>, std::pair<size_t, bool>> seen;
        for (size_t t = 0; t < open.size() && !surface.twoSided; ++t) {
            std::array<Place, 3> corners;
            for (int k = 0; k < 3; ++k) {
                const glm::vec3& p = surface.positions[surface.triangles[t][k]];
                corners[k] = {p.x, p.y, p.z};
            }
            std::array<Place, 3> sorted = corners;
            std::sort(sorted.begin(), sorted.end());
            const auto first = std::find(corners.begin(), corners.end(), sorted[0]) - corners.begin();
            const bool turned = corners[(first + 1) % 3] != sorted[1];
            const auto [place, isNew] = seen.try_emplace(sorted, t, turned);
            if (!isNew && place->second.second != turned) open[t] = open[place->second.first] = true;
        }
        out.push_back(std::move(open));
    }
    return out;
}

}  // namespace

Solids::Solids(const Scene& scene, const Tracer& tracer) : scene_(scene), tracer_(tracer), twoSided_(twoSided(scene)) {}

int Solids::backsSeen(const SurfacePoint& point, double spin, int probes) const {
    static const std::vector<glm::vec3> usual = fibonacciHemisphere(kProbes);
    const glm::mat3 frame = frameFromZ(point.normal, spin);
    int backs = 0;
    for (const glm::vec3& w : probes == kProbes ? usual : fibonacciHemisphere(probes)) {
        const std::optional<Hit> hit = tracer_.nearest(rayOrigin(tracer_, point), frame * w);
        backs += hit && isBack(*hit);
    }
    return backs;
}

bool Solids::comesOut(const SurfacePoint& from, const SurfacePoint& to) const {
    const glm::dvec3 start = rayOrigin(tracer_, from);
    const std::optional<Hit> hit = tracer_.nearest(start, glm::vec3(rayOrigin(tracer_, to) - start));
    return hit && hit->distance < 1 && isBack(*hit);
}

}  // namespace apertura
