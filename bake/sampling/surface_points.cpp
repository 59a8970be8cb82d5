#include "bake/sampling/surface_points.h"

#include <algorithm>
#include <cmath>

#include "bake/sampling/directions.h"
#include "runtime/asset/error.h"

namespace apertura {
namespace {

bool inside(const Box& box, const glm::vec3& p) {
    return glm::all(glm::greaterThanEqual(p, box.low)) && glm::all(glm::lessThanEqual(p, box.high));
}

}  // namespace

std::vector<SurfaceSample> sampleSurface(const Scene& scene, int count, uint32_t seed, const SurfaceRegion& region) {
    struct Corner {
        glm::dvec3 p[3];
    };
    auto corners = [&](const Instance& instance, size_t t) {
        const Surface& surface = scene.surfaces[instance.surface];
        Corner c;
        for (int k = 0; k < 3; ++k)
            c.p[k] = worldPosition(instance, surface.positions[surface.triangles[t][k]]);
        return c;
    };
    std::vector<double> sums;  // running area, one a candidate triangle
    std::vector<std::pair<int, int>> places;
    double total = 0;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Surface& surface = scene.surfaces[scene.instances[i].surface];
        if (!region.surfaces.empty() && !region.surfaces[size_t(scene.instances[i].surface)]) continue;
        for (size_t t = 0; t < surface.triangles.size(); ++t) {
            const Corner c = corners(scene.instances[i], t);
            const glm::vec3 low(glm::min(c.p[0], glm::min(c.p[1], c.p[2]))), high(glm::max(c.p[0], glm::max(c.p[1], c.p[2])));
            const bool near = region.boxes.empty()
                           || std::any_of(region.boxes.begin(), region.boxes.end(), [&](const Box& box) {
                                  return glm::all(glm::lessThanEqual(low, box.high))
                                      && glm::all(glm::greaterThanEqual(high, box.low));
                              });
            const double area = 0.5 * glm::length(glm::cross(c.p[1] - c.p[0], c.p[2] - c.p[0]));
            if (!near || !(area > 0)) continue;
            sums.push_back(total += area);
            places.emplace_back(int(i), int(t));
        }
    }
    if (!(total > 0)) throw Error(scene.name + ": no triangle has an area");

    std::vector<SurfaceSample> out;
    // Triangles reach over the edge of a box: points outside are drawn again, with new numbers.
    for (uint64_t k = 0, tries = 0; out.size() < size_t(count) && tries < 100ull * count; ++k, ++tries) {
        const double golden = 0.6180339887498949;
        const double along = std::fmod(hashUnit(seed, 0, 11) + golden * double(k), 1.0) * total;
        const size_t at = std::min<size_t>(std::upper_bound(sums.begin(), sums.end(), along) - sums.begin(), sums.size() - 1);
        const auto [i, t] = places[at];
        const Instance& instance = scene.instances[i];
        const Surface& surface = scene.surfaces[instance.surface];
        const Corner c = corners(instance, t);
        const double root = std::sqrt(hashUnit(seed, k, 12)), v = hashUnit(seed, k, 13);
        SurfaceSample point;
        point.instance = i;
        point.triangle = t;
        point.weights = glm::vec3(1 - root, root * (1 - v), root * v);
        point.at.position = double(point.weights.x) * c.p[0] + double(point.weights.y) * c.p[1] + double(point.weights.z) * c.p[2];
        point.at.longest = std::max({glm::distance(c.p[0], c.p[1]), glm::distance(c.p[1], c.p[2]), glm::distance(c.p[2], c.p[0])});
        if (!region.boxes.empty()
            && std::none_of(region.boxes.begin(), region.boxes.end(),
                            [&](const Box& box) { return inside(box, point.at.position); }))
            continue;
        const glm::dvec3 n = glm::normalize(glm::cross(c.p[1] - c.p[0], c.p[2] - c.p[0]));
        glm::vec3 shading(0);
        for (int corner = 0; corner < 3; ++corner) shading += surface.normals[surface.triangles[t][corner]];
        shading = normalMatrix(instance.toWorld) * shading;
        point.at.normal = glm::vec3(glm::dot(n, glm::dvec3(shading)) < 0 ? -n : n);
        out.push_back(point);
    }
    if (out.empty()) throw Error(scene.name + ": no part of its surface lies in the region asked for");
    return out;
}

}  // namespace apertura
