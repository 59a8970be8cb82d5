#pragma once
// glTF 2.0 files, read and kept whole, so that an asset can be written back with nothing lost.
#include <tiny_gltf.h>

#include <functional>
#include <nlohmann/json_fwd.hpp>

#include "runtime/error.h"
#include "runtime/scene.h"

namespace apertura {

struct GltfDocument {
    tinygltf::Model model;  // compressed views decoded, instancing extensions spelled out as nodes
    std::string json;       // as it stood in the file: tinygltf does not keep every value
};

// Reads .glb or .gltf with its buffers and images: meshes, primitives (lists, strips and fans), node
// transforms, instances, sparse, interleaved and quantised accessors, EXT_meshopt_compression and
// EXT_mesh_gpu_instancing. Points and lines are kept but not part of the scene. Normals are made where
// there are none. Throws Error naming `path` for anything that is broken or needs an unknown extension.
Scene readGltf(const std::string& path);

// An accessor's elements as floats (normalised integers already mapped), `components` an element.
// Bounds, strides and types are checked against the buffers. Throws Error naming `path`.
std::vector<float> readAccessor(const tinygltf::Model& model, int accessor, int components,
                                const std::string& path);

// The bytes of a .gltf or .glb with its JSON changed by `edit`, or as they are where it returns false.
// Throws Error naming `path`, or what the JSON parser throws.
std::vector<unsigned char> editGltfJson(std::vector<unsigned char> bytes, const std::string& path,
                                        const std::function<bool(nlohmann::json&)>& edit);

}  // namespace apertura
