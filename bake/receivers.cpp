#include "bake/receivers.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/error.h"

namespace apertura {
namespace {

constexpr double kPi = std::numbers::pi;

bool inside(const Box& box, const glm::vec3& p) {
    return glm::all(glm::greaterThanEqual(p, box.low)) && glm::all(glm::lessThanEqual(p, box.high));
}

}  // namespace

std::vector<SpreadPoint> spreadReceivers(const Scene& scene, int count, uint32_t seed) {
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
        if (!surface.receives) continue;
        for (size_t t = 0; t < surface.triangles.size(); ++t) {
            const Corner c = corners(scene.instances[i], t);
            const glm::vec3 low(glm::min(c.p[0], glm::min(c.p[1], c.p[2]))), high(glm::max(c.p[0], glm::max(c.p[1], c.p[2])));
            const bool near = scene.receiverBoxes.empty()
                           || std::any_of(scene.receiverBoxes.begin(), scene.receiverBoxes.end(), [&](const Box& box) {
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

    std::vector<SpreadPoint> out;
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
        SpreadPoint point;
        point.instance = i;
        point.triangle = t;
        point.weights = glm::vec3(1 - root, root * (1 - v), root * v);
        point.at.position = double(point.weights.x) * c.p[0] + double(point.weights.y) * c.p[1] + double(point.weights.z) * c.p[2];
        point.at.longest = std::max({glm::distance(c.p[0], c.p[1]), glm::distance(c.p[1], c.p[2]), glm::distance(c.p[2], c.p[0])});
        if (!scene.receiverBoxes.empty()
            && std::none_of(scene.receiverBoxes.begin(), scene.receiverBoxes.end(),
                            [&](const Box& box) { return inside(box, point.at.position); }))
            continue;
        const glm::dvec3 n = glm::normalize(glm::cross(c.p[1] - c.p[0], c.p[2] - c.p[0]));
        glm::vec3 shading(0);
        for (int corner = 0; corner < 3; ++corner) shading += surface.normals[surface.triangles[t][corner]];
        shading = normalMatrix(instance.toWorld) * shading;
        point.at.normal = glm::vec3(glm::dot(n, glm::dvec3(shading)) < 0 ? -n : n);
        out.push_back(point);
    }
    if (out.empty()) throw Error(scene.name + ": no receiver fits");
    return out;
}

std::vector<glm::vec3> lightDirections(const Scene& scene, const SurfacePoint& receiver, uint32_t seed, size_t index) {
    const glm::vec3 up = scene.skyAboveGround ? glm::vec3(0, 1, 0) : receiver.normal;
    const glm::mat3 frame = frameAbout(up, 2 * kPi * hashUnit(seed, index, 21));
    std::vector<glm::vec3> out;
    for (const glm::vec3& w : hemisphereLattice(80)) out.push_back(frame * w);
    for (double elevation : {3.0, 8.0})
        for (int i = 0; i < 8; ++i) {
            const double turn = 2 * kPi * i / 8 + elevation, e = elevation * kPi / 180;
            out.push_back(frame * glm::vec3(std::cos(e) * std::cos(turn), std::cos(e) * std::sin(turn), std::sin(e)));
        }
    return out;
}

TruthSample traceLight(const Tracer& tracer, const SurfacePoint& receiver, const glm::vec3& direction, double radius,
                       int samples, double spin) {
    const double height = 2 * std::sin(radius / 2) * std::sin(radius / 2);
    const glm::mat3 frame = frameAbout(direction, spin);
    std::vector<glm::vec3> rays;
    for (const glm::vec3& w : capLattice(samples, height)) rays.push_back(frame * w);
    std::vector<uint8_t> blocked(rays.size());
    tracer.occluded(rayOrigin(tracer, receiver), rays, kNoLimit, blocked.data());
    double sum[2]{};
    for (size_t i = 0; i < rays.size(); ++i)
        if (!blocked[i]) sum[i & 1] += std::max(glm::dot(rays[i], receiver.normal), 0.0f);
    // The cap's 2 pi h sr over pi sin^2 r, a half having samples / 2 of them.
    const double scale = 2 * height / (std::sin(radius) * std::sin(radius)) / (samples / 2.0);
    return {float(sum[0] * scale), float(sum[1] * scale)};
}

}  // namespace apertura
