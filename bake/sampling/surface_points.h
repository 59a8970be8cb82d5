#pragma once
// Points spread over a scene's surfaces.
#include <cstdint>
#include <vector>

#include "apertura/bake/sampling/vertices.h"

namespace apertura {

// A part of a scene; by default all of it.
struct SurfaceRegion {
    std::vector<bool> surfaces;  // one for each of the scene's; empty: all
    std::vector<Box> boxes;      // world, metres: within any of them; empty: everywhere
};

// A point of a triangle, with the geometric normal on the side of the vertex normals.
struct SurfaceSample {
    SurfacePoint at;
    int instance, triangle;
    glm::vec3 weights;  // barycentric
};

// `count` points over the region, evenly by area; fewer where they hardly ever fall into its boxes (after 100 tries a
// point). The same seed gives the same points everywhere. Throws Error with the scene's name where the region has no
// area.
std::vector<SurfaceSample> sampleSurface(const Scene& scene, int count, uint32_t seed, const SurfaceRegion& region = {});

}  // namespace apertura
