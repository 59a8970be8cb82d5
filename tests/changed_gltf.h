#pragma once
#include <functional>
#include <string>

#include "apertura/runtime/asset/gltf_document.h"
#include "apertura/runtime/asset/gltf_writer.h"
#include "tests/support.h"

namespace apertura::test {

// Writes a document again with its JSON changed, and returns its path.
inline std::string changed(const Folder& folder, const std::string& path, const std::function<void(Json&)>& change) {
    GltfDocument document = readGltfDocument(path);
    change(document.json);
    GltfWriter(document).write(folder / "changed.glb", folder / "changed.glb");
    return folder / "changed.glb";
}

}  // namespace apertura::test
