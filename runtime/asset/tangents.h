#pragma once
// The frames that engines turn normal maps by.
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "runtime/asset/scene.h"

namespace apertura {

// Tangents as glTF has them: x, y, z unit, the way in which u grows; w is 1 or -1, so that w cross(normal, tangent) is the way in which v
// falls: up in the image.

// One per position, of these coordinates: the mean of the triangles' tangents in the plane of the vertex's normal, weighted by angles, over
// all that meet there with the same place, normal and coordinates. (Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", 2008, whose
// MikkTSpace glTF names; where charts do not fold back on themselves it takes the same triangles together.) Where no triangle has an area
// in the coordinates, any tangent.
std::vector<glm::vec4> makeTangents(const Surface& surface, std::span<const glm::vec2> coordinates);

// Those of the primitive's own TANGENT; where it has none, made from the coordinates that its normal map is laid over, else from those of
// the surface. `made`, where given: whether they are not the file's.
std::vector<glm::vec4> tangentsOf(const Scene& scene, size_t instance, bool* made = nullptr);

// Columns: tangent, bitangent and normal at a point of a triangle, unit, in the surface's frame, as a shader has them that interpolates
// normals and tangents. `barycentrics`: as for surfaceAt.
glm::mat3 tangentFrame(const Surface& surface, std::span<const glm::vec4> tangents, size_t triangle, const glm::vec3& barycentrics);

}  // namespace apertura
