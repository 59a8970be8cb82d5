#pragma once
// Scenes from glTF 2.0 files. A scene keeps the whole document, so that an asset can be written with nothing lost.
#include <filesystem>
#include <span>
#include <string>

#include "apertura/runtime/asset/scene.h"

namespace apertura {

// Reads .glb or .gltf with its buffers and images: meshes, primitives (lists, strips and fans), node
// transforms, instances, sparse, interleaved and quantised accessors, EXT_meshopt_compression and
// EXT_mesh_gpu_instancing. Points and lines are kept but not part of the scene. Primitives without normals are flat, as
// glTF requires: their vertices are split where faces meet. Throws Error naming `path` if anything is broken, an unknown
// extension is required, more than half of this machine's memory is needed, or a URI leads outside the file's folder.
Scene readGltf(const std::string& path);

// The same from memory. `name` begins the errors; URIs are relative to `folder`.
Scene parseGltf(std::span<const unsigned char> bytes, const std::string& name, const std::filesystem::path& folder);

}  // namespace apertura
