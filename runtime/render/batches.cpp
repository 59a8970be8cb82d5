#include "apertura/runtime/render/batches.h"

#include <algorithm>

#include "apertura/runtime/asset/materials.h"

namespace apertura {
namespace {

void drawBatch(const DrawPass& pass, const BoundPart& part, const Materials& materials, const Batch& batch) {
    materials.bind(pass.commands(), part.bindings->layout(), batch.material);
    pass.drawRange(batch.first, batch.count, part.indices);
}

}  // namespace

std::vector<Batch> batchesOf(const Asset& asset, const GeometryPart& part) {
    std::vector<Batch> out;
    uint32_t first = 0;
    for (const GeometryPiece& piece : part.pieces) {
        const Instance& instance = asset.scene.instances[size_t(piece.instance)];
        const Surface& surface = asset.scene.surfaces[size_t(instance.surface)];
        const Material::Alpha alpha = materialOf(asset.scene, surface).alpha;
        const auto count = uint32_t(piece.corners.size());
        if (!out.empty() && alpha != Material::Alpha::Blend && out.back().material == surface.material) {
            out.back().count += count;
        } else {
            Box box;
            for (const uint32_t v : piece.vertices) {
                const glm::vec3 at(worldPosition(instance, surface.positions[v]));
                box.low = glm::min(box.low, at), box.high = glm::max(box.high, at);
            }
            out.push_back({surface.material, alpha, first, count, 0.5f * (box.low + box.high)});
        }
        first += count;
    }
    return out;
}

void drawBatches(const DrawPass& pass, std::span<const BoundPart> parts, const Materials& materials, Material::Alpha alpha,
                 vk::Pipeline pipeline) {
    pass.use(pipeline);
    for (const BoundPart& part : parts) {
        bool isBound = false;
        for (const Batch& batch : *part.batches) {
            if (batch.alpha != alpha) continue;
            if (!isBound) pass.bind(*part.bindings, part.offsets, part.indices);
            isBound = true;
            drawBatch(pass, part, materials, batch);
        }
    }
}

void drawBlended(const DrawPass& pass, std::span<const BoundPart> parts, const Materials& materials, const glm::vec3& eye,
                 vk::Pipeline pipeline) {
    std::vector<std::pair<const BoundPart*, const Batch*>> all;
    for (const BoundPart& part : parts)
        for (const Batch& batch : *part.batches)
            if (batch.alpha == Material::Alpha::Blend) all.emplace_back(&part, &batch);
    std::stable_sort(all.begin(), all.end(), [&](const auto& a, const auto& b) {
        return glm::distance(a.second->centre, eye) > glm::distance(b.second->centre, eye);
    });
    pass.use(pipeline);
    for (const auto& [part, batch] : all) {
        pass.bind(*part->bindings, part->offsets, part->indices);
        drawBatch(pass, *part, materials, *batch);
    }
}

}  // namespace apertura
