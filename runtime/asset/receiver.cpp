#include "apertura/runtime/asset/receiver.h"

#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/faces.h"
#include "apertura/runtime/asset/texels.h"
#include "apertura/sh/shading.h"

namespace apertura {
namespace {

// True where the asset stores the model's parameters.
bool holds(const Asset& asset, const Model& model) {
    const Model* const stored = storedModel(asset.info);
    return stored && stored->id == model.id;
}

}  // namespace

WeightedReceivers receiverAt(const Asset& asset, const Model& model, int instance, int triangle, const glm::vec3& barycentrics,
                             const glm::vec3& normal) {
    const Instance& placed = asset.scene.instances[size_t(instance)];
    const Surface& surface = asset.scene.surfaces[size_t(placed.surface)];
    const SeenByInstance& seen = asset.seen[size_t(instance)];
    const glm::mat3 normals = normalMatrix(placed.toWorld);
    const bool stored = holds(asset, model);
    Visibility visibility;
    ModelParams mix{};
    WeightedReceivers corners;
    const auto add = [&](float weight, const Visibility& own, const std::vector<ModelParams>& allParams, size_t at,
                         const glm::vec3& facing) {
        const ModelParams params = toParams(model, own, stored && !allParams.empty() ? &allParams[at] : nullptr, facing);
        visibility.direction += weight * own.direction;
        visibility.area += weight * own.area;
        for (size_t k = 0; k < APERTURA_MAX_SLOTS; ++k) mix[k] += weight * params[k];
        corners.emplace_back(weight, toReceiver(own, params, normal));
    };
    if (!seen.texels.visibility.empty()) {
        const AperturaTexelCell cell = texelCell(surface, size_t(triangle), barycentrics, seen.texels.width, seen.texels.height);
        static const std::vector<ModelParams> none;
        for (int c = 0; c < 4; ++c) {
            const auto at = size_t(cell.texels[c]);
            add(cell.weights[c], seen.texels.visibility[at], none, 0, seen.texels.normals[at]);
        }
    } else if (const int level = seen.faces.level(size_t(triangle)); level > 0) {
        const AperturaLatticeCell cell = aperturaLatticeCell(barycentrics, aperturaLatticeSteps(level));
        for (int c = 0; c < 3; ++c) {
            const size_t at = seen.faces.first[size_t(triangle)] + size_t(cell.samples[c]);
            add(cell.weights[c], seen.faces.visibility[at], seen.faces.allParams, at,
                surfaceAt(asset.scene, instance, triangle, latticePoint(cell.samples[c], aperturaLatticeSteps(level))).looking());
        }
    } else {
        for (int c = 0; c < 3; ++c) {
            const uint32_t v = surface.triangles[size_t(triangle)][size_t(c)];
            add(barycentrics[c], seen.visibility[v], seen.allParams, v, normals * surface.normals[v]);
        }
    }
    if (!model.mixes) return corners;
    // As scene.frag has it.
    if (!seen.texels.visibility.empty() && model.id == APERTURA_MODEL_SOFT)
        return {{1.0f, toReceiver(visibility,
                                  toParams(model, visibility, nullptr, surfaceAt(asset.scene, instance, triangle, barycentrics).looking()),
                                  normal)}};
    return {{1.0f, aperturaRenormalised(model.id, toReceiver(visibility, mix, normal))}};
}

AperturaReceiver receiverAtVertex(const Asset& asset, const Model& model, size_t instance, size_t vertex) {
    const std::string& name = asset.scene.name;
    if (instance >= asset.seen.size()) throw Error(name + ": there is no instance " + std::to_string(instance));
    const SeenByInstance& seen = asset.seen[instance];
    if (vertex >= seen.visibility.size())
        throw Error(name + ": instance " + std::to_string(instance) + " has no vertex " + std::to_string(vertex));
    const bool stored = holds(asset, model) && !seen.allParams.empty();
    if (!stored && !model.fromVisibility) throw Error(name + ": does not hold the model " + std::string(model.name));
    const Instance& placed = asset.scene.instances[instance];
    const glm::vec3& own = asset.scene.surfaces[size_t(placed.surface)].normals[vertex];
    const glm::vec3 scaled = normalMatrix(placed.toWorld) * own;
    const glm::vec3 normal = glm::dot(scaled, scaled) > 0 ? glm::normalize(scaled) : own;
    const Visibility& visibility = seen.visibility[vertex];
    return toReceiver(visibility, toParams(model, visibility, stored ? &seen.allParams[vertex] : nullptr, normal), normal);
}

}  // namespace apertura
