#pragma once
// Light that bounces: paths of diffuse reflections through a scene (Kajiya, "The Rendering Equation", 1986).
#include <cmath>
#include <numbers>

#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/sampling/solids.h"

namespace apertura {

// What a scene's surfaces reflect, rgb, 0..1: the base colours of their materials, or `plain` where `isPlain` says so and in scenes that
// have no materials.
struct Albedo {
    glm::vec3 plain{0.8f};
    bool isPlain = false;
};

// The albedo of what a ray met, and how much of the ray it stops, 0..1.
glm::vec4 albedoAt(const Scene& scene, const Hit& hit, const Albedo& albedo);

// Follows light backwards from `origin` along `direction` (unit, world) over at most `bounces` reflections. Surfaces are flat and reflect
// on both sides; those that blend let a part of the paths through. The same `seed` and `path` give the same path everywhere.
//   visitor.ends(origin, direction, distance)        true: the path ends before it comes so far, metres; kNoLimit: out of the scene
//   visitor.reflects(hit, point, throughput)         light comes from here: `throughput` / pi times the irradiance of the point, which
//                                                    looks at the path; false: the path ends here
//   visitor.escapes(direction, throughput)           and the sky's radiance from there
template <typename Visitor>
void followPath(const Tracer& tracer, const Albedo& albedo, glm::dvec3 origin, glm::vec3 direction, int bounces, uint32_t seed,
                uint64_t path, Visitor&& visitor) {
    constexpr int kMostLayers = 64;  // that blend, and are passed
    glm::vec3 throughput(1);
    uint64_t number = uint64_t(1) << 40;  // of hashes: those of others begin at 0
    for (int bounce = 0, layers = 0;;) {
        const std::optional<Hit> hit = tracer.nearest(origin, direction);
        if (visitor.ends(origin, direction, hit ? hit->distance : kNoLimit)) return;
        if (!hit) return visitor.escapes(direction, throughput);
        const glm::vec4 colour = albedoAt(tracer.scene(), *hit, albedo);
        SurfacePoint point{hit->at.position, hit->at.face, hit->at.longest};
        if (colour.a < 1 && layers < kMostLayers && hashUnit(seed, path, number++) >= double(colour.a)) {
            origin = hit->at.position + 4 * tracer.offset(hit->at.position) * glm::dvec3(direction);
            ++layers;
            continue;
        }
        throughput *= glm::vec3(colour);
        if (bounce++ == bounces || throughput == glm::vec3(0)) return;
        if (glm::dot(point.normal, direction) > 0) point.normal = -point.normal;
        if (!visitor.reflects(*hit, point, throughput)) return;
        const double turn = 2 * std::numbers::pi * hashUnit(seed, path, number), squared = hashUnit(seed, path, number + 1);
        number += 2;
        const double across = std::sqrt(squared);
        direction = frameFromZ(point.normal, turn) * glm::vec3(float(across), 0, float(std::sqrt(1 - squared)));
        origin = rayOrigin(tracer, point);
    }
}

// The irradiance of a point under a sky of unit radiance, over pi, rgb: the mean of `rays` paths. The sky alone, without a bounce, gives
// the cosine-weighted open part of its hemisphere. Noise: less than 0.5 / sqrt(rays).
glm::vec3 skyByPaths(const Tracer& tracer, const Albedo& albedo, const SurfacePoint& point, int rays, int bounces, uint32_t seed,
                     uint64_t index);

}  // namespace apertura
