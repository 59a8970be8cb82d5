#pragma once
// Scenes from files and from the built-in names.
#include <optional>
#include <string>
#include <vector>

#include "runtime/asset/scene.h"

namespace apertura {

// How a height map is read; all other files ignore it.
struct HeightMapOptions {
    double spacingX = 1, spacingZ = 1;  // metres between texels, east and south
    double verticalScale = 1;           // metres a unit of height
    bool terrainRgb = false;            // R, G, B hold -10000 + 0.1 (65536 R + 256 G + B) metres
};

// `name` is a path (.glb .gltf .obj .ply .stl, or a height map .png .tif .tiff .exr) or builtin:NAME.
// Throws Error naming it and the cause.
Scene loadScene(const std::string& name, const HeightMapOptions& options = {});

// Whether loadScene takes a path for a height map's, by its ending.
bool isHeightMap(const std::string& path);

// The parts of loadScene.
Scene loadMeshFile(const std::string& path);                                    // .obj .ply .stl, by assimp
Scene loadHeightMap(const std::string& path, const HeightMapOptions& options);  // by OpenImageIO
Scene makeBuiltin(const std::string& name);                                     // without builtin:, see builtinNames

// A built-in scene, and where its models are measured.
struct BuiltinScene {
    Scene scene;
    std::vector<bool> receives;      // surfaces that have receivers
    std::vector<Box> receiverBoxes;  // world, metres: receivers lie in these; everywhere when empty
    bool skyAboveGround = true;      // lit from above the horizontal; or else from everywhere
};
// That of "builtin:NAME", made anew; nothing where there is none of that name.
std::optional<BuiltinScene> findBuiltin(const std::string& name);

// The nine procedural scenes of the charts, seeded: the same bytes everywhere.
const std::vector<std::string>& builtinNames();

}  // namespace apertura
