#include "apertura/bake/sampling/surface_points.h"

#include <algorithm>
#include <cmath>

#include "apertura/bake/sampling/directions.h"
#include "apertura/runtime/asset/error.h"

namespace apertura {
namespace {

bool inside(const Box& box, const glm::vec3& p) {
    return glm::all(glm::greaterThanEqual(p, box.low)) && glm::all(glm::lessThanEqual(p, box.high));
}

}  // namespace

std::vector<SurfaceSample> sampleSurface(const Scene& scene, int count, uint32_t seed, const SurfaceRegion& region) {
    std::vector<double> sums;  // running area, one per candidate triangle
    std::vector<std::pair<int, int>> places;
    double total = 0;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Surface& surface = scene.surfaces[scene.instances[i].surface];
        if (!region.surfaces.empty() && !region.surfaces[size_t(scene.instances[i].surface)]) continue;
        for (size_t t = 0; t < surface.triangles.size(); ++t) {
            const std::array<glm::dvec3, 3> c = cornersOf(scene, int(i), int(t));
            const glm::vec3 low(glm::min(c[0], glm::min(c[1], c[2]))), high(glm::max(c[0], glm::max(c[1], c[2])));
            const bool near = region.boxes.empty() || std::any_of(region.boxes.begin(), region.boxes.end(), [&](const Box& box) {
                                  return glm::all(glm::lessThanEqual(low, box.high)) && glm::all(glm::greaterThanEqual(high, box.low));
                              });
            const double area = 0.5 * glm::length(glm::cross(c[1] - c[0], c[2] - c[0]));
            if (!near || !(area > 0)) continue;
            sums.push_back(total += area);
            places.emplace_back(int(i), int(t));
        }
    }
    if (!(total > 0)) throw Error(scene.name + ": no triangle has an area");

    std::vector<SurfaceSample> out;
    // A triangle may reach beyond a box: points outside are drawn again, with new numbers.
    for (uint64_t k = 0, tries = 0; out.size() < size_t(count) && tries < 100ull * count; ++k, ++tries) {
        const double golden = 0.6180339887498949;
        const double along = std::fmod(hashUnit(seed, 0, 11) + golden * double(k), 1.0) * total;
        const size_t place = std::min<size_t>(std::upper_bound(sums.begin(), sums.end(), along) - sums.begin(), sums.size() - 1);
        const auto [i, t] = places[place];
        const double root = std::sqrt(hashUnit(seed, k, 12)), v = hashUnit(seed, k, 13);
        SurfaceSample point;
        point.instance = i;
        point.triangle = t;
        point.weights = glm::vec3(1 - root, root * (1 - v), root * v);
        const SurfaceAt at = surfaceAt(scene, i, t, point.weights);
        point.at = {at.position, at.face, at.longest};
        if (!region.boxes.empty()
            && std::none_of(region.boxes.begin(), region.boxes.end(), [&](const Box& box) { return inside(box, point.at.position); }))
            continue;
        out.push_back(point);
    }
    if (out.empty()) throw Error(scene.name + ": no part of its surface lies in the region asked for");
    return out;
}

}  // namespace apertura
