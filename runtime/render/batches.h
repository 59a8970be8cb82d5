#pragma once
// Triangles of one material that are drawn at once, and in which order.
#include <functional>
#include <span>
#include <vector>

#include "apertura/runtime/render/draw.h"
#include "apertura/runtime/render/geometry.h"
#include "apertura/runtime/render/materials.h"

namespace apertura {

struct Batch {
    int material;  // of the scene's, or -1
    Material::Alpha alpha;
    uint32_t first, count;  // of the part's indices
    glm::vec3 centre;       // world, metres
};

// Those of a part, in its order. What blends has a batch for each instance.
std::vector<Batch> batchesOf(const Asset& asset, const GeometryPart& part);

// A part of the geometry with all that a pass reads of it.
struct BoundPart {
    const GpuBindings* bindings;
    std::vector<uint32_t> offsets;  // bytes, one per dynamic binding
    const GpuBuffer* indices;       // null: the shader reads them itself
    const std::vector<Batch>* batches;
};

// Draws all batches of a kind, in their order. `pipeline`: of that kind.
void drawBatches(const DrawPass& pass, std::span<const BoundPart> parts, const Materials& materials, Material::Alpha alpha,
                 vk::Pipeline pipeline);

// Draws those that blend, the farthest first.
void drawBlended(const DrawPass& pass, std::span<const BoundPart> parts, const Materials& materials, const glm::vec3& eye,
                 vk::Pipeline pipeline);

}  // namespace apertura
