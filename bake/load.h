#pragma once
// Scenes from files and from the built-in names.
#include <string>
#include <vector>

#include "runtime/scene.h"

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
Scene makeBuiltin(const std::string& name);  // without builtin:, see builtinNames

// Measures `scene`, read back from an asset of builtin:NAME, at the receivers and by the lights of the
// original. Any other `from` leaves it as it is.
void adoptReceivers(Scene& scene, const std::string& from);

// The nine procedural scenes of the charts, seeded: the same bytes everywhere.
const std::vector<std::string>& builtinNames();

}  // namespace apertura
