#pragma once
// Visibility at a point of a surface, interpolated from the vertices, the samples of its face or the texels about it, as shaders/scene.frag
// does for a pixel.
#include <array>
#include <glm/glm.hpp>
#include <utility>
#include <vector>

#include "apertura/runtime/asset/asset.h"
#include "apertura/sh/models.h"

namespace apertura {

// Receivers and weights, which sum to 1: the light of the point is the weighted sum of theirs. One receiver if the model's
// parameters may be interpolated, otherwise those of the triangle's three corners or of four texels.
using WeightedReceivers = std::vector<std::pair<float, AperturaReceiver>>;

// The receivers at a point of a triangle.
//   model         the one that the asset stores, or one that is derived from the four numbers
//   barycentrics  as for surfaceAt
//   normal        of the lit surface, unit, world
WeightedReceivers receiverAt(const Asset& asset, const Model& model, int instance, int triangle, const glm::vec3& barycentrics,
                             const glm::vec3& normal);

// The three vertices or samples of its face about a point of a triangle, and their weights. Not for instances with images.
struct SamplesAbout {
    bool onFace;  // of SeenOnFaces; else vertices
    std::array<size_t, 3> at;
    glm::vec3 weights;
};
SamplesAbout samplesAbout(const Surface& surface, const SeenByInstance& seen, size_t triangle, const glm::vec3& barycentrics);

// What surfaces reflect to a point of a triangle, as the asset stores it (hasBounces).
AperturaBounce bounceAt(const Asset& asset, int instance, int triangle, const glm::vec3& barycentrics);

// The receiver at a vertex of an instance, with the vertex's normal in the world: what evaluateLight takes. Throws Error naming the asset
// if it has no such instance or vertex, or does not hold the model.
AperturaReceiver receiverAtVertex(const Asset& asset, const Model& model, size_t instance, size_t vertex);

}  // namespace apertura
