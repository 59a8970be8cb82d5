#include "apertura/bake/sampling/solids.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <map>

#include <oneapi/tbb/parallel_for.h>

#include "apertura/bake/sampling/classes.h"
#include "apertura/bake/sampling/directions.h"

namespace apertura {
namespace {

// Of a part of a two-sided material, so many of its points look behind it, by so many rays each; it is a skin where no more of these than
// kThrough see the sky and no fewer than kBacks meet the back of a face.
constexpr int kLooks = 64, kLookRays = 8;
constexpr double kThrough = 0.008, kBacks = 0.25;

using Place = std::array<float, 3>;

// For each surface, the triangles with a twin that faces the other way.
std::vector<std::vector<bool>> findTwins(const Scene& scene) {
    std::vector<std::vector<bool>> out;
    for (const Surface& surface : scene.surfaces) {
        std::vector<bool> open(surface.triangles.size(), false);
        // Key: sorted corners. Value: a triangle, and whether sorting reversed its winding.
        std::map<std::array<Place, 3>, std::pair<size_t, bool>> seen;
        for (size_t t = 0; t < open.size(); ++t) {
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

// The triangles of each part of a surface that hangs together at its corners.
std::vector<std::vector<size_t>> partsOf(const Surface& surface) {
    std::map<Place, uint32_t> places;
    Classes classes(surface.triangles.size());
    for (size_t t = 0; t < surface.triangles.size(); ++t)
        for (const uint32_t v : surface.triangles[t]) {
            const glm::vec3& p = surface.positions[v];
            classes.join(uint32_t(t), places.try_emplace({p.x, p.y, p.z}, uint32_t(t)).first->second);
        }
    std::vector<std::vector<size_t>> out;
    std::vector<size_t> numbers(surface.triangles.size());
    for (size_t t = 0; t < surface.triangles.size(); ++t) {
        const uint32_t first = classes.find(uint32_t(t));  // never after t
        if (first == t) {
            numbers[t] = out.size();
            out.emplace_back();
        }
        out[numbers[first]].push_back(t);
    }
    return out;
}

// Whether a ray leaves the box, metres, by another side than its bottom: what stands in the ground needs none.
bool leavesAboveGround(const Box& box, const glm::dvec3& origin, const glm::vec3& direction) {
    if (direction.y >= 0) return true;
    const glm::dvec3 down = origin + glm::dvec3(direction) * ((box.low.y - origin.y) / direction.y);
    return down.x < box.low.x || down.x > box.high.x || down.z < box.low.z || down.z > box.high.z;
}

}  // namespace

Solids::Solids(const Scene& scene, const Tracer& tracer)
    : scene_(scene), tracer_(tracer), twins_(findTwins(scene)), thin_(scene.instances.size()) {
    for (size_t i = 0; i < scene.instances.size(); ++i)
        if (scene.surfaces[size_t(scene.instances[i].surface)].twoSided) findThin(i);
}

void Solids::findThin(size_t instance) {
    const Surface& surface = scene_.surfaces[size_t(scene_.instances[instance].surface)];
    const std::vector<std::vector<size_t>> parts = partsOf(surface);
    const std::vector<glm::vec3> directions = fibonacciHemisphere(kLookRays);
    const Box bounds = worldBounds(scene_);
    std::vector<uint8_t> isThin(parts.size());
    tbb::parallel_for(size_t(0), parts.size(), [&](size_t part) {
        std::vector<double> areas{0};  // of the triangles up to each, m2
        for (const size_t t : parts[part]) {
            const std::array<glm::dvec3, 3> c = cornersOf(scene_, int(instance), int(t));
            areas.push_back(areas.back() + glm::length(glm::cross(c[1] - c[0], c[2] - c[0])));
        }
        if (!(areas.back() > 0)) return;
        int sky = 0, backs = 0;
        const uint64_t place = uint64_t(instance) << 32 | parts[part][0];
        for (int k = 0; k < kLooks && !isThin[part]; ++k) {
            const uint64_t turn = 4 * uint64_t(k);
            const double at = (k + hashUnit(1, place, turn)) / kLooks * areas.back();
            const auto found = std::upper_bound(areas.begin() + 1, areas.end() - 1, at) - areas.begin() - 1;
            const size_t t = parts[part][size_t(found)];
            double u = hashUnit(1, place, turn + 1), v = hashUnit(1, place, turn + 2);
            if (u + v > 1) u = 1 - u, v = 1 - v;
            const SurfaceAt on = surfaceAt(scene_, int(instance), int(t), glm::vec3(1 - u - v, u, v));
            const SurfacePoint behind{on.position, -on.face, on.longest};
            const glm::mat3 frame = frameFromZ(behind.normal, 2 * std::numbers::pi * hashUnit(1, place, turn + 3));
            for (const glm::vec3& w : directions) {
                const glm::vec3 direction = frame * w;
                const glm::dvec3 origin = rayOrigin(tracer_, behind);
                const std::optional<Hit> hit = tracer_.nearest(origin, direction);
                if (hit)
                    backs += hit->back;
                else
                    sky += leavesAboveGround(bounds, origin, direction);
            }
            isThin[part] = sky > kThrough * kLooks * kLookRays;
        }
        isThin[part] = isThin[part] || backs < kBacks * kLooks * kLookRays;
    });
    std::vector<bool> thin = twins_[size_t(scene_.instances[instance].surface)];
    for (size_t part = 0; part < parts.size(); ++part) {
        closed_ += !isThin[part];
        for (const size_t t : parts[part]) thin[t] = thin[t] || isThin[part];
    }
    thin_[instance] = std::move(thin);
}

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
