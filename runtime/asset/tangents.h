#pragma once
// The frames that engines turn normal maps by.
#include <array>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "apertura/runtime/asset/scene.h"

namespace apertura {

// Tangents as glTF has them: x, y, z unit, the way in which u grows; w is 1 or -1, so that w cross(normal, tangent) is the way in which v
// falls: up in the image.

// Of each corner of each triangle.
using Tangents = std::vector<std::array<glm::vec4, 3>>;

// Made of these coordinates, one per position: the mean of the triangles' tangents in the plane of the vertex's normal, weighted by angles,
// over all that meet there with the same place, normal and coordinates and whose coordinates turn the same way. (Mikkelsen, "Simulation of
// Wrinkled Surfaces Revisited", 2008, whose MikkTSpace glTF names.) Where no triangle has an area in the coordinates, any tangent.
Tangents makeTangents(const Surface& surface, std::span<const glm::vec2> coordinates);

// What engines have of an instance: the primitive's own TANGENT, but for one that an earlier bake made; else what they make from the
// coordinates that its normal map is laid over; and where it has no such map, of those of the surface. Throws Error naming the scene and
// the mesh where the file's are no unit vectors.
//   toStore  where given, one per position if the file has no use for others: it has neither tangents nor a normal map. Else empty
Tangents tangentsOf(const Scene& scene, size_t instance, std::vector<glm::vec4>* toStore = nullptr);

extern const char* const kMadeTangents;  // the name of accessors of tangents that a bake made

// Columns: tangent, bitangent and normal at a point of a triangle, unit, in the surface's frame, as a shader has them that interpolates
// normals and tangents. `barycentrics`: as for surfaceAt.
glm::mat3 tangentFrame(const Surface& surface, const Tangents& tangents, size_t triangle, const glm::vec3& barycentrics);

}  // namespace apertura
