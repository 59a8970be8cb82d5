#pragma once
// A glTF 2.0 file whole: its JSON as it stands and the bytes that it refers to, every number checked against what
// there is before memory is asked for. Specification: Khronos, "glTF 2.0", 2021.
//
// What a file may make us read: itself, data URIs, and ordinary files in its own folder and below. What it may make
// us allocate: as much as its bytes decode to.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "runtime/asset/error.h"

namespace apertura {

using Json = nlohmann::json;
using Bytes = std::vector<unsigned char>;
using SharedBytes = std::shared_ptr<const Bytes>;  // never null; entries that name one file share it

struct GltfDocument {
    std::string name;                  // of the file, as errors begin with it
    Json json;                         // of the right structure, all indices in range
    std::vector<SharedBytes> buffers;  // one an entry of json["buffers"]
    std::vector<SharedBytes> images;   // one an entry of json["images"]; empty for those in a buffer view
    std::set<size_t> decodedViews;     // those that were compressed in the file
    size_t fileBytes = 0;              // of the file and of what it refers to, each counted once
    std::vector<std::string> notes;    // what is amiss but can be worked with, a line each
};

// A file may refer to the same bytes many times, and then stands for more than it holds: honest ones up to some
// hundred times (a forest of one tree), hostile ones a million times. Adds up what is spelled out and throws Error
// naming the document where that is more than `base` and `factor` for each of its bytes.
class Budget {
public:
    Budget(const GltfDocument& document, const char* what, double base, double factor);
    void spend(double amount);

private:
    std::string name_, what_;
    double left_;
};

// The numbers of JSON that glTF gives to component types and topologies.
enum GltfComponent { kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126 };
enum GltfMode { kPoints = 0, kTriangles = 4, kTriangleStrip = 5, kTriangleFan = 6 };
enum GltfTarget { kNoTarget = 0, kArrayBuffer = 34962, kElementArrayBuffer = 34963 };

// Reads .glb or .gltf with its buffers and images. Compressed views (EXT_meshopt_compression) come out decoded, and
// instances (EXT_mesh_gpu_instancing) as nodes. Throws Error naming `path` for anything that is broken, needs an
// unknown extension, or reaches for what it was not given.
GltfDocument readGltfDocument(const std::string& path);

// The same from memory; what URIs name is looked for in `folder`.
GltfDocument parseGltfDocument(std::span<const unsigned char> bytes, const std::string& name, const std::filesystem::path& folder);

// The bytes of a buffer view. Throws Error naming the document where there is no view of this index.
std::span<const unsigned char> viewBytes(const GltfDocument& document, size_t view);

// Elements of an accessor.
size_t accessorCount(const GltfDocument& document, size_t accessor);

// An accessor's elements as floats (normalised integers already mapped), `components` an element. Throws Error naming
// the document where it has another number of components, or more elements than the file can justify.
std::vector<float> readAccessor(const GltfDocument& document, size_t accessor, int components);

// An accessor's elements as whole numbers. Throws Error where it is not a scalar of unsigned integers.
std::vector<uint32_t> readIndices(const GltfDocument& document, size_t accessor);

// An accessor of the elements `from` of another: its JSON but for where its bytes are, and those, each element at a
// multiple of four bytes.
struct GatheredAccessor {
    Json members;
    Bytes bytes;
    size_t stride = 0;  // bytes from one element to the next
};
GatheredAccessor gatherAccessor(const GltfDocument& document, size_t accessor, std::span<const uint32_t> from);

// The files of runtime/gltf_*.cpp among themselves:

// The JSON chunk and, of a .glb, the binary one.
struct GltfContainer {
    std::span<const unsigned char> json, binary;
    bool isBinary = false;
    bool hasMore = false;  // chunks of other kinds follow
};
GltfContainer splitContainer(std::span<const unsigned char> bytes, const std::string& name);
// Throws Error unless everything that is read of the JSON has the right type and every index is in range.
void checkStructure(const Json& json, const std::string& name);
// Throws Error unless accessors lie in their views.
void checkAccessors(const GltfDocument& document);
// What a URI names: data that it holds itself, or an ordinary file in the document's folder or below.
struct UriSource {
    std::string uri;
    std::filesystem::path file;  // canonical; empty where the URI is data, or there is no such file
    bool isData() const { return uri.starts_with("data:"); }
};
// Throws Error naming the URI where it leads anywhere else.
UriSource resolveUri(const std::string& uri, const std::filesystem::path& folder, const std::string& name);
// Its bytes; nothing where there is no such file. Throws Error naming the URI where it cannot be read, or its bytes are
// not `length` of them.
std::optional<Bytes> readUri(const UriSource& source, std::optional<size_t> length, const std::string& name);
// Takes away what says the same a second time, compressed by an extension that nobody has to know: Draco,
// KHR_meshopt_compression.
void dropAlternatives(Json& json);
// Replaces each compressed view by a plain one with a buffer of its own.
void decodeMeshopt(GltfDocument& document);
// Spells instances out as child nodes: each sees a sky of its own.
void expandInstancing(GltfDocument& document);

// The non-negative integer `object[key]`, or `fallback` where it has none. Only for what checkStructure has seen.
inline size_t unsignedOr(const Json& object, const char* key, size_t fallback) {
    const auto found = object.find(key);
    return found == object.end() ? fallback : found->get<size_t>();
}
// The array or object `object[key]`, or an empty one.
inline const Json& listOf(const Json& object, const char* key) {
    static const Json none = Json::array();
    const auto found = object.find(key);
    return found == object.end() ? none : *found;
}

}  // namespace apertura
