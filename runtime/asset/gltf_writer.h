#pragma once
// Adds to a glTF document and writes it as .glb. What stood in its JSON stays, value by value; bytes that nothing refers
// to any more are left out.
#include <string>

#include "runtime/asset/gltf_document.h"

namespace apertura {

class GltfWriter {
public:
    explicit GltfWriter(const GltfDocument& document);

    Json& json() { return json_; }
    // Adds bytes as a buffer view, an array of glTF's numbers as an accessor; returns its index.
    size_t addView(SharedBytes bytes, GltfTarget target = kNoTarget, size_t stride = 0);
    size_t addView(Bytes bytes, GltfTarget target = kNoTarget, size_t stride = 0);
    size_t addAccessor(Json members, Bytes bytes, GltfTarget target, size_t stride = 0);

    // Says that one use of an accessor or a view is gone from the JSON. Those without any other make room: for what is
    // added afterwards, or by leaving the file.
    void release(const std::set<size_t>& accessors, const std::set<size_t>& views = {});

    // All buffers and images as one, into a file. Throws Error naming `path`.
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
