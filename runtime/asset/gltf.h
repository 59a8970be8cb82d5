#pragma once
// Scenes from glTF 2.0 files, whose documents they keep whole, so that an asset can be written back with nothing lost.
#include <filesystem>
#include <span>
#include <string>

#include "runtime/asset/scene.h"

namespace apertura {

// Reads .glb or .gltf with its buffers and images: meshes, primitives (lists, strips and fans), node
// transforms, instances, sparse, interleaved and quantised accessors, EXT_meshopt_compression and
// EXT_mesh_gpu_instancing. Points and lines are kept but not part of the scene. Primitives without normals are flat, as
// glTF has it: their vertices are split where faces meet. Throws Error naming `path` for anything that is broken, needs
// an unknown extension or more memory than this machine has, or reaches for files outside its folder.
Scene readGltf(const std::string& path);

// The same from memory; what URIs name is looked for in `folder`.
Scene parseGltf(std::span<const unsigned char> bytes, const std::string& name, const std::filesystem::path& folder);

}  // namespace apertura
