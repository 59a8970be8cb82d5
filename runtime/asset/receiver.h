#pragma once
// Visibility read at a point of a surface, from where the asset stores it: what shaders/scene.frag does for a pixel.
#include <glm/glm.hpp>
#include <utility>
#include <vector>

#include "runtime/asset/asset.h"
#include "sh/models.h"

namespace apertura {

// Receivers whose light is to be mixed by their weights, which sum to 1: one, where the model's parameters may be
// interpolated, and otherwise those of the triangle's three corners.
using WeightedReceivers = std::vector<std::pair<float, Receiver>>;

// At a point of a triangle, which the asset holds `model` of. `barycentrics` as of surfaceAt; `normal` (unit, world) is what
// is lit.
WeightedReceivers receiverAt(const Asset& asset, const Model& model, int instance, int triangle, const glm::vec3& barycentrics,
                             const glm::vec3& normal);

}  // namespace apertura
