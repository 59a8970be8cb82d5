#include "apertura/bake/measure/seams.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "apertura/bake/sampling/directions.h"
#include "apertura/runtime/asset/receiver.h"
#include "apertura/sh/shading.h"

namespace apertura {
namespace {

constexpr float kOnePlane = 0.9999f;  // cosine between the faces
constexpr int kLights = 24;           // over each point's hemisphere

struct Side {
    int triangle, from, to;  // corners that the edge leads between
};

struct Edge {
    int instance;
    Side sides[2];
};

// The edges that two triangles of one plane share: between faces of equal density, and of unequal density.
std::array<std::vector<Edge>, 2> findEdges(const Asset& asset) {
    using Place = std::array<float, 3>;
    std::array<std::vector<Edge>, 2> out;
    for (size_t i = 0; i < asset.scene.instances.size(); ++i) {
        const Surface& surface = asset.scene.surfaces[size_t(asset.scene.instances[i].surface)];
        std::map<std::pair<Place, Place>, std::vector<Side>> sides;
        for (size_t t = 0; t < surface.triangles.size(); ++t)
            for (int c = 0; c < 3; ++c) {
                Side side{int(t), c, (c + 1) % 3};
                const auto place = [&](int corner) {
                    const glm::vec3& p = surface.positions[surface.triangles[t][size_t(corner)]];
                    return Place{p.x, p.y, p.z};
                };
                if (place(side.to) < place(side.from)) std::swap(side.from, side.to);
                sides[{place(side.from), place(side.to)}].push_back(side);
            }
        for (const auto& [ends, two] : sides) {
            if (two.size() != 2 || ends.first == ends.second) continue;
            const auto normal = [&](const Side& side) { return surfaceAt(asset.scene, int(i), side.triangle, glm::vec3(1 / 3.0f)).face; };
            if (!(glm::dot(normal(two[0]), normal(two[1])) > kOnePlane)) continue;
            const SeenOnFaces& faces = asset.seen[i].faces;
            const bool unequal = faces.level(size_t(two[0].triangle)) != faces.level(size_t(two[1].triangle));
            out[unequal].push_back({int(i), {two[0], two[1]}});
        }
    }
    return out;
}

}  // namespace

std::vector<Seam> measureSeams(const Asset& asset, const std::vector<const Model*>& models, const std::vector<double>& radii, size_t edges,
                               uint32_t seed) {
    const std::array<std::vector<Edge>, 2> all = findEdges(asset);
    const std::vector<glm::vec3> lights = fibonacciHemisphere(kLights);
    std::vector<Seam> out;
    for (const Model* model : models)
        for (const double radius : radii)
            for (const bool unequal : {false, true}) {
                const std::vector<Edge>& own = all[unequal];
                Seam seam{std::string(model->name), radius, unequal, own.size(), 0, 0};
                const auto sinRadius = float(std::sin(radius * std::numbers::pi / 180));
                const size_t step = own.size() / std::max<size_t>(edges, 1) + 1;
                double sum = 0, count = 0;
                for (size_t e = 0; e < own.size(); e += step) {
                    const auto along = float(hashUnit(seed, e, 1));
                    const glm::vec3 normal = surfaceAt(asset.scene, own[e].instance, own[e].sides[0].triangle, glm::vec3(1 / 3.0f)).face;
                    WeightedReceivers receivers[2];
                    for (int s = 0; s < 2; ++s) {
                        glm::vec3 weights(0);
                        weights[own[e].sides[s].from] = 1 - along, weights[own[e].sides[s].to] = along;
                        receivers[s] = receiverAt(asset, *model, own[e].instance, own[e].sides[s].triangle, weights, normal);
                    }
                    const glm::mat3 frame = frameFromZ(normal, 2 * std::numbers::pi * hashUnit(seed, e, 2));
                    for (const glm::vec3& l : lights) {
                        const AperturaCapLight light = aperturaCapLight(frame * l, sinRadius);
                        double jump = 0;
                        for (int s = 0; s < 2; ++s)
                            for (const auto& [share, receiver] : receivers[s])
                                jump += (s ? -1 : 1) * share
                                      * aperturaIrradianceThrough(model->id, receiver, light, lightClassOf(sinRadius)) / light.area;
                        seam.max = std::max(seam.max, std::abs(jump));
                        sum += jump * jump, ++count;
                    }
                }
                seam.rms = count > 0 ? std::sqrt(sum / count) : 0;
                out.push_back(seam);
            }
    return out;
}

}  // namespace apertura
