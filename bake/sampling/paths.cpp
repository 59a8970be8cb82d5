#include "apertura/bake/sampling/paths.h"

#include "apertura/runtime/asset/materials.h"

namespace apertura {
namespace {

// Sums the sky of unit radiance.
struct UnderSky {
    glm::dvec3 sum{0};
    bool ends(const glm::dvec3&, const glm::vec3&, float) const { return false; }
    bool reflects(const Hit&, const SurfacePoint&, const glm::vec3&) const { return true; }
    void escapes(const glm::vec3&, const glm::vec3& throughput) { sum += throughput; }
};

}  // namespace

glm::vec4 albedoAt(const Scene& scene, const Hit& hit, const Albedo& albedo) {
    glm::vec4 base(albedo.plain, 1);
    if (!scene.materials.empty()) {
        const Surface& surface = scene.surfaces[size_t(scene.instances[size_t(hit.instance)].surface)];
        base = baseColourAt(scene, surface, size_t(hit.triangle), hit.barycentrics);
        if (albedo.isPlain) base = glm::vec4(albedo.plain, base.a);
    }
    return {glm::clamp(glm::vec3(base), 0.0f, 1.0f), base.a};
}

glm::vec3 skyByPaths(const Tracer& tracer, const Albedo& albedo, const SurfacePoint& point, int rays, int bounces, uint32_t seed,
                     uint64_t index) {
    UnderSky sky;
    const glm::mat3 frame = frameFromZ(point.normal, 2 * std::numbers::pi * hashUnit(seed, index, 31));
    const glm::dvec3 origin = rayOrigin(tracer, point);
    uint64_t path = index * uint64_t(rays);
    for (const glm::vec3& w : fibonacciCosine(rays)) followPath(tracer, albedo, origin, frame * w, bounces, seed, path++, sky);
    return sky.sum / double(rays);
}

}  // namespace apertura
