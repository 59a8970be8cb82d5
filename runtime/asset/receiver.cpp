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
    } else {
        const SamplesAbout about = samplesAbout(surface, seen, size_t(triangle), barycentrics);
        const int steps = aperturaLatticeSteps(std::max(seen.faces.level(size_t(triangle)), 1));
        for (size_t c = 0; c < 3; ++c) {
            const size_t at = about.at[c];
            const float weight = about.weights[int(c)];
            if (about.onFace)
                add(weight, seen.faces.visibility[at], seen.faces.allParams, at,
                    surfaceAt(asset.scene, instance, triangle, latticePoint(int(at - seen.faces.first[size_t(triangle)]), steps))
                        .looking());
            else
                add(weight, seen.visibility[at], seen.allParams, at, normals * surface.normals[at]);
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

SamplesAbout samplesAbout(const Surface& surface, const SeenByInstance& seen, size_t triangle, const glm::vec3& barycentrics) {
    SamplesAbout out{false, {}, barycentrics};
    if (const int level = seen.faces.level(triangle); level > 0) {
        const AperturaLatticeCell cell = aperturaLatticeCell(barycentrics, aperturaLatticeSteps(level));
        out = {true, {}, cell.weights};
        for (size_t c = 0; c < 3; ++c) out.at[c] = seen.faces.first[triangle] + size_t(cell.samples[int(c)]);
    } else {
        for (size_t c = 0; c < 3; ++c) out.at[c] = surface.triangles[triangle][c];
    }
    return out;
}

AperturaBounce bounceAt(const Asset& asset, int instance, int triangle, const glm::vec3& barycentrics) {
    const SeenByInstance& seen = asset.seen[size_t(instance)];
    const Surface& surface = asset.scene.surfaces[size_t(asset.scene.instances[size_t(instance)].surface)];
    const SamplesAbout about = samplesAbout(surface, seen, size_t(triangle), barycentrics);
    AperturaBounce out{glm::vec3(0), glm::vec3(0)};
    for (size_t c = 0; c < 3; ++c) {
        const AperturaBounce& own = about.onFace ? seen.faces.bounces[about.at[c]] : seen.bounces[about.at[c]];
        out.share += about.weights[int(c)] * own.share;
        out.towards += about.weights[int(c)] * own.towards;
    }
    return out;
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
