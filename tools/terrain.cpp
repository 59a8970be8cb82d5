#include "tools/terrain.h"

#include <algorithm>

#include "apertura/bake/scene/height_mesh.h"
#include "apertura/runtime/asset/error.h"
#include "tools/terminal.h"

namespace apertura {
namespace {

constexpr double kMeshError = 0.1;  // of a texel's side

}  // namespace

Scene meshToSweep(const std::string& name, const HeightMap& map, bool inTexels, double meshError, double& reached) {
    requireMeshable(name, map.field);
    std::vector<Surface> tiles;
    if (inTexels) {
        reached = meshError >= 0 ? meshError : kMeshError * std::min(map.field.spacingX, map.field.spacingZ);
        ProgressBar bar("meshing");
        tiles = decimatedMesh(map.field, reached, bar.callback());
    } else {
        tiles.push_back(fullMesh(map.field));
    }
    if (tiles.empty() || tiles[0].triangles.empty()) throw Error(name + ": no three texels that meet have data");
    Scene scene = terrainScene(name, std::move(tiles));
    scene.notes = map.notes;
    return scene;
}

}  // namespace apertura
