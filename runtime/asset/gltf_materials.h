#pragma once
#include "apertura/runtime/asset/gltf_document.h"
#include "apertura/runtime/asset/materials.h"

namespace apertura {

// Reads the document's materials and what its textures say beside their images into the scene. Members that glTF does not have so count as
// missing.
void readMaterials(Scene& scene);

// Of a primitive: what places its textures and colours its vertices; empty where neither is the case.
std::vector<VertexPaint> readPaint(const Scene& scene, const Json& primitive, size_t vertices);

}  // namespace apertura
