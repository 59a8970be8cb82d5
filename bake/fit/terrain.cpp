#include "apertura/bake/fit/terrain.h"

#include <cassert>
#include <cmath>
#include <deque>

#include "apertura/bake/sampling/horizon_occlusion.h"
#include "apertura/bake/sampling/vertices.h"

namespace apertura {
namespace {

constexpr int kFittedAzimuths = 64;  // that models are fitted to: a sector is as wide as a light of 3 degrees

// The texel of a vertex of a mesh over the field.
glm::ivec2 texelOf(const HeightField& field, const glm::vec3& p) {
    return {std::lround(p.x / field.spacingX + 0.5 * (field.width - 1)), std::lround(p.z / field.spacingZ + 0.5 * (field.height - 1))};
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

// The vertices that triangles use.
VertexPoints verticesOf(const Scene& scene) {
    VertexPoints out;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Surface& surface = scene.surfaces[size_t(scene.instances[i].surface)];
        std::vector<bool> isUsed(surface.positions.size(), false);
        for (const auto& t : surface.triangles)
            for (const uint32_t v : t) isUsed[v] = true;
        for (size_t v = 0; v < surface.positions.size(); ++v)
            if (isUsed[v]) {
                out.points.push_back({glm::dvec3(surface.positions[v]), surface.normals[v]});
                out.places.emplace_back(i, v);
            }
    }
    return out;
}

Visibility seenAt(const OpenSky& sky, size_t texel) { return clampToPossible({sky.direction[texel], sky.area[texel]}); }

}  // namespace

BakedVisibility bakeTerrain(const Scene& scene, const HeightField& field, const BakeOptions& options, const HorizonOptions& horizons,
                            const Progress& progress, AutoPlan* plan, TerrainReport* report) {
    assert(options.as == As::Visibility && options.at != At::Faces && (options.recipe == "sh" || options.at == At::Vertices));
    if (options.recipe != "sh") {
        const HorizonOcclusion source(field, kFittedAzimuths, horizons, part(progress, 0, 0.2));
        if (report) report->azimuths = kFittedAzimuths;
        return bakeAt(scene, source, verticesOf(scene), options, part(progress, 0.2, 1), plan);
    }
    const OpenSky sky = openSky(field, options.error, horizons, progress);
    if (report) *report = {sky.azimuths, sky.areaError, sky.directionError};
    const auto indexOf = [&](const glm::ivec2& texel) { return size_t(texel.y) * size_t(field.width) + size_t(texel.x); };
    const std::vector<uint32_t> from = options.at == At::Texels ? nearestWithData(field) : std::vector<uint32_t>();
    BakedVisibility out;
    for (const Surface& surface : scene.surfaces) {
        SeenByInstance& seen = out.emplace_back();
        for (const glm::vec3& p : surface.positions) seen.visibility.push_back(seenAt(sky, indexOf(texelOf(field, p))));
        if (options.at != At::Texels) continue;
        // The tile's first texel, from any of its vertices.
        const glm::ivec2 first = texelOf(field, surface.positions[0]) - glm::ivec2(surface.coordinates[0] * glm::vec2(surface.grid));
        seen.texels = {surface.grid.x, surface.grid.y, {}, {}, 8};
        seen.texels.visibility.reserve(size_t(surface.grid.x) * size_t(surface.grid.y));
        for (int y = 0; y < surface.grid.y; ++y)
            for (int x = 0; x < surface.grid.x; ++x) seen.texels.visibility.push_back(seenAt(sky, from[indexOf(first + glm::ivec2(x, y))]));
    }
    return out;
}

}  // namespace apertura
