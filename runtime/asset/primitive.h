#pragma once
// The primitive of an instance in its document, and what its vertices are there.
#include <cstdint>
#include <vector>

#include "apertura/runtime/asset/gltf_document.h"
#include "apertura/runtime/asset/scene.h"

namespace apertura {

// The index of the mesh that the instance's node has in the document's JSON.
inline size_t meshOf(const Json& json, const Instance& instance) { return json["nodes"][size_t(instance.node)]["mesh"].get<size_t>(); }

inline const Json& primitiveOf(const GltfDocument& document, const Instance& instance) {
    return document.json["meshes"][meshOf(document.json, instance)]["primitives"][size_t(instance.primitive)];
}

// What split vertices have: that of the vertices that they came from. False where there are too few; `all` is as it was where none were
// split.
template <typename T>
bool pick(std::vector<T>& all, const std::vector<uint32_t>& from) {
    if (all.empty() || from.empty()) return true;
    std::vector<T> out;
    out.reserve(from.size());
    for (const uint32_t i : from) {
        if (i >= all.size()) return false;
        out.push_back(all[i]);
    }
    all = std::move(out);
    return true;
}

}  // namespace apertura
