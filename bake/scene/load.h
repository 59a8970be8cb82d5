#pragma once
// Scenes from files and from the built-in names.
#include <optional>
#include <string>
#include <vector>

#include "apertura/runtime/asset/scene.h"

namespace apertura {

// How a height map is read. Other files ignore it.
struct HeightMapOptions {
    double spacingX = 0, spacingZ = 0;  // metres between texels to the east and to the south; 0: those that the file states, else 1
    double verticalScale = 1;           // metres per unit of height, > 0
    bool terrainRgb = false;            // the height is -10000 + 0.1 (65536 R + 256 G + B) metres
};

// Whether texture coordinates are read from meshes of other kinds than glTF, whose vertices they split, and made for height maps.
enum class Coordinates { Ignore, Read };

// Reads a scene and checks it with validate().
//   name     a path (.glb .gltf .obj .ply .stl, or a height map .png .tif .tiff .exr) or builtin:NAME
//   options  for height maps alone
// Throws Error that names `name` and the cause.
Scene loadScene(const std::string& name, const HeightMapOptions& options = {}, Coordinates coordinates = Coordinates::Ignore);

// True if loadScene reads the path as a height map. Its ending decides, in upper or lower case.
bool isHeightMap(const std::string& path);

// loadScene calls one of these for each kind. They throw as it does.
Scene loadMeshFile(const std::string& path, Coordinates coordinates);                                    // .obj .ply .stl, by assimp
Scene loadHeightMap(const std::string& path, const HeightMapOptions& options, Coordinates coordinates);  // by OpenImageIO
Scene makeBuiltin(const std::string& name);                                                              // one of builtinNames

}  // namespace apertura
