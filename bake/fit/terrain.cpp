#include "apertura/bake/fit/terrain.h"

#include <cassert>
#include <cmath>
#include <deque>

#include "apertura/bake/sampling/horizon_occlusion.h"
#include "apertura/bake/sampling/vertices.h"

namespace apertura {
namespace {

constexpr int kFittedAzimuths = 64;  // that models are fitted to: a sector is as wide as a light of 3 degrees

// Of each vertex of the surface, its texel: the index in the field.
size_t texelOf(const HeightField& field, const Surface& surface, size_t vertex) {
    const glm::vec2 at = surface.coordinates[vertex] * glm::vec2(field.width, field.height);
    return size_t(int(at.y)) * size_t(field.width) + size_t(int(at.x));
}

// For each texel, one with data that is near: itself where it has some.
std::vector<uint32_t> nearestWithData(const HeightField& field) {
    std::vector<uint32_t> from(field.texels(), UINT32_MAX);
    std::deque<uint32_t> next;
    const auto neighbours = [&](uint32_t i, const auto& use) {
        const int x = int(i) % field.width, y = int(i) / field.width;
        for (const auto& [dx, dy] : {std::pair(1, 0), {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}})
            if (x + dx >= 0 && x + dx < field.width && y + dy >= 0 && y + dy < field.height) use(uint32_t((y + dy) * field.width + x + dx));
    };
    for (uint32_t i = 0; i < from.size(); ++i)
        if (!std::isnan(field.heights[i])) from[i] = i;
    for (uint32_t i = 0; i < from.size(); ++i)
        if (from[i] == i)
            neighbours(i, [&](uint32_t n) {
                if (from[n] == UINT32_MAX) from[n] = i, next.push_back(n);
            });
    for (; !next.empty(); next.pop_front())
        neighbours(next.front(), [&](uint32_t n) {
            if (from[n] == UINT32_MAX) from[n] = from[next.front()], next.push_back(n);
        });
    return from;
}

Visibility seenAt(const OpenSky& sky, size_t texel) { return clampToPossible({sky.direction[texel], sky.area[texel]}); }

}  // namespace

BakedVisibility bakeTerrain(const Scene& scene, const HeightField& field, const BakeOptions& options, const HorizonOptions& horizons,
                            const Progress& progress, AutoPlan* plan, TerrainReport* report) {
    const Surface& surface = scene.surfaces.front();
    assert(options.as == As::Visibility && options.at != At::Faces && (options.recipe == "sh" || options.at == At::Vertices));
    if (options.recipe != "sh") {
        const HorizonOcclusion source(field, kFittedAzimuths, horizons, part(progress, 0, 0.2));
        if (report) report->azimuths = kFittedAzimuths;
        VertexPoints vertices;
        std::vector<bool> isUsed(surface.positions.size(), false);
        for (const auto& t : surface.triangles)
            for (const uint32_t v : t) isUsed[v] = true;
        for (size_t v = 0; v < surface.positions.size(); ++v)
            if (isUsed[v]) {
                vertices.points.push_back({glm::dvec3(surface.positions[v]), surface.normals[v]});
                vertices.places.emplace_back(0, v);
            }
        return bakeAt(scene, source, vertices, options, part(progress, 0.2, 1), plan);
    }
    const OpenSky sky = openSky(field, options.error, horizons, progress);
    if (report) *report = {sky.azimuths, sky.areaError, sky.directionError};
    BakedVisibility out(1);
    for (size_t v = 0; v < surface.positions.size(); ++v) out[0].visibility.push_back(seenAt(sky, texelOf(field, surface, v)));
    if (options.at != At::Texels) return out;
    const std::vector<uint32_t> from = nearestWithData(field);
    out[0].texels = {field.width, field.height, {}, {}, 8};
    out[0].texels.visibility.reserve(from.size());
    for (const uint32_t i : from) out[0].texels.visibility.push_back(seenAt(sky, i));
    return out;
}

}  // namespace apertura
