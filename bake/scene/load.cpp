#include "apertura/bake/scene/load.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>

#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/file.h"
#include "apertura/runtime/asset/gltf.h"
#include "apertura/runtime/asset/materials.h"

namespace apertura {
namespace {

const std::string kBuiltinPrefix = "builtin:";

std::string endingOf(const std::string& path) {
    std::string ending = std::filesystem::path(path).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
    return ending;
}

}  // namespace

bool isHeightMap(const std::string& path) {
    static const std::set<std::string> maps{".png", ".tif", ".tiff", ".exr"};
    return !path.starts_with(kBuiltinPrefix) && maps.contains(endingOf(path));
}

Scene loadScene(const std::string& name, const HeightMapOptions& options, Coordinates coordinates) {
    if (name.starts_with(kBuiltinPrefix)) return makeBuiltin(name.substr(kBuiltinPrefix.size()));
    requireOrdinaryFile(name);
    const std::string ending = endingOf(name);
    static const std::set<std::string> meshes{".obj", ".ply", ".stl"};
    if (ending == ".glb" || ending == ".gltf") {
        Scene scene = readGltf(name);
        loadTextures(scene, TexturesFor::Rays);
        return scene;
    }
    if (meshes.contains(ending)) return loadMeshFile(name, coordinates);
    if (isHeightMap(name)) return loadHeightMap(name, options, coordinates);
    throw Error(name + ": unknown kind of file; scenes are .glb .gltf .obj .ply .stl, height maps .png .tif .exr, or "
                       "builtin:NAME");
}

}  // namespace apertura
