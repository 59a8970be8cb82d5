#include "runtime/asset/receiver.h"

namespace apertura {

WeightedReceivers receiverAt(const Asset& asset, const Model& model, int instance, int triangle, const glm::vec3& barycentrics,
                             const glm::vec3& normal) {
    const Instance& placed = asset.scene.instances[size_t(instance)];
    const Surface& surface = asset.scene.surfaces[size_t(placed.surface)];
    const SeenByInstance& seen = asset.seen[size_t(instance)];
    const glm::mat3 normals = normalMatrix(placed.toWorld);
    const bool stored = storedModel(asset.info) == &model && !seen.allParams.empty();
    Visibility visibility;
    ModelParams mix{};
    WeightedReceivers corners;
    for (int c = 0; c < 3; ++c) {
        const uint32_t v = surface.triangles[size_t(triangle)][size_t(c)];
        const float w = barycentrics[c];
        const ModelParams params = toParams(model, seen.visibility[v], stored ? &seen.allParams[v] : nullptr, normals * surface.normals[v]);
        visibility.direction += w * seen.visibility[v].direction;
        visibility.area += w * seen.visibility[v].area;
        for (size_t k = 0; k < MAX_SLOTS; ++k) mix[k] += w * params[k];
        corners.emplace_back(w, toReceiver(seen.visibility[v], params, normal));
    }
    if (!model.mixes) return corners;
    return {{1.0f, renormalised(model.id, toReceiver(visibility, mix, normal))}};
}

}  // namespace apertura
