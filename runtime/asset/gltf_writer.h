#pragma once
// Adds to a glTF document and writes it as .glb. JSON that the caller does not change is kept, value by value, except for
// indices that move; bytes that nothing refers to any more are left out.
#include <string>

#include "apertura/runtime/asset/gltf_document.h"

namespace apertura {

class GltfWriter {
public:
    explicit GltfWriter(const GltfDocument& document);

    Json& json() { return json_; }
    // Adds bytes as a buffer view, or as an accessor in a view of its own, and returns the index.
    //   members  the accessor's JSON without bufferView
    //   stride   bytes between elements; 0: tightly packed
    size_t addView(SharedBytes bytes, GltfTarget target = kNoTarget, size_t stride = 0);
    size_t addView(Bytes bytes, GltfTarget target = kNoTarget, size_t stride = 0);
    size_t addAccessor(Json members, Bytes bytes, GltfTarget target, size_t stride = 0);
    size_t addAccessor(Json members);  // that says where its bytes are

    // Reports that a use of these accessors and views was removed from the JSON. Those that have no other use are given to
    // later addView and addAccessor calls, or are left out of the file.
    void release(const std::set<size_t>& accessors, const std::set<size_t>& views = {});

    // Writes all to the file `temporary`, with buffers and images in one binary chunk. Throws Error naming `path` if it
    // cannot be written or is larger than the 4 GiB of a .glb.
    void write(const std::string& path, const std::string& temporary);

private:
    void embedImages();
    void removeReleased();
    std::vector<std::span<const unsigned char>> packBuffers();

    Json json_;
    std::vector<SharedBytes> buffers_, images_;
    std::set<size_t> freeAccessors_, freeViews_;
};

}  // namespace apertura
