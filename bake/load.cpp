#include "bake/load.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>

#include "runtime/error.h"
#include "runtime/gltf.h"

namespace apertura {

Scene loadScene(const std::string& name, const HeightMapOptions& options) {
    const std::string prefix = "builtin:";
    if (name.starts_with(prefix)) return makeBuiltin(name.substr(prefix.size()));
    std::error_code ignored;
    if (std::filesystem::is_directory(name, ignored)) throw Error(name + ": is a folder");
    std::ifstream in(name, std::ios::binary);
    if (!in) throw Error(name + ": cannot be opened: " + std::strerror(errno));
    if (in.peek() == std::ifstream::traits_type::eof()) throw Error(name + ": the file is empty");
    in.close();

    std::string ending = std::filesystem::path(name).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
    static const std::set<std::string> meshes{".obj", ".ply", ".stl"}, maps{".png", ".tif", ".tiff", ".exr"};
    if (ending == ".glb" || ending == ".gltf") return readGltf(name);
    if (meshes.contains(ending)) return loadMeshFile(name);
    if (maps.contains(ending)) return loadHeightMap(name, options);
    throw Error(name + ": unknown kind of file; scenes are .glb .gltf .obj .ply .stl, height maps .png .tif .exr, or "
                       "builtin:NAME");
}

}  // namespace apertura
