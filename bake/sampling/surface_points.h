#pragma once
// Points spread over a scene's surfaces.
#include <cstdint>
#include <vector>

#include "bake/sampling/vertices.h"

namespace apertura {

// A part of a scene: all of it, as it stands.
struct SurfaceRegion {
    std::vector<bool> surfaces;  // which of the scene's; empty: all
    std::vector<Box> boxes;      // world, metres: within any of them; empty: everywhere
};

// A point inside a triangle, with the geometric normal (turned to the side of the vertex normals).
struct SurfaceSample {
    SurfacePoint at;
    int instance, triangle;
    glm::vec3 weights;  // barycentric
};

// `count` points over the region, evenly by area; the same for a seed everywhere. Throws Error naming the scene where it
// has no area there.
std::vector<SurfaceSample> sampleSurface(const Scene& scene, int count, uint32_t seed, const SurfaceRegion& region = {});

}  // namespace apertura
