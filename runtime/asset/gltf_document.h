#pragma once
// A whole glTF 2.0 file: its JSON unchanged and the bytes that it refers to. Every number is checked against the bytes
// that exist before memory is allocated. Specification: Khronos, "glTF 2.0", 2021.
//
// A file can make us read itself, data URIs, and ordinary files in its own folder and below; and allocate as much as its
// bytes decode to.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "apertura/runtime/asset/error.h"

namespace apertura {

struct Camera;
struct Scene;

using Json = nlohmann::json;
using Bytes = std::vector<unsigned char>;
using SharedBytes = std::shared_ptr<const Bytes>;  // never null; entries that name the same file share it

struct GltfDocument {
    std::string name;                  // of the file; errors begin with it
    Json json;                         // checked: types are right and indices in range
    std::vector<SharedBytes> buffers;  // one per entry of json["buffers"]
    std::vector<SharedBytes> images;   // one per entry of json["images"]; empty for those in a buffer view
    std::set<size_t> decodedViews;     // buffer views that were compressed in the file
    size_t fileBytes = 0;              // size of the file and of all that it refers to, each counted once
    std::vector<std::string> notes;    // faults that the reader works around, a line each
};

// Limits how far a document may expand. A file can refer to the same bytes many times: a harmless one some hundred times
// (a forest of one tree), a hostile one a million times.
//   what          what is counted, in the plural, for the error
//   base, factor  spend() throws Error naming the document when the sum exceeds base + factor * fileBytes
class Budget {
public:
    Budget(const GltfDocument& document, const char* what, double base, double factor);
    void spend(double amount);

private:
    std::string name_, what_;
    double left_;
};

// Approximate size of a copy of some JSON, in values.
double valuesIn(const Json& json);

// glTF's numbers for component types, topologies and the targets of buffer views.
enum GltfComponent { kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126 };
enum GltfMode { kPoints = 0, kTriangles = 4, kTriangleStrip = 5, kTriangleFan = 6 };
enum GltfTarget { kNoTarget = 0, kArrayBuffer = 34962, kElementArrayBuffer = 34963 };

// Reads .glb or .gltf with its buffers and images. Compressed views (EXT_meshopt_compression) are decoded and instances
// (EXT_mesh_gpu_instancing) become nodes. Throws Error naming `path` if anything is broken, an unknown extension is
// required, or a URI leads outside the file's folder.
GltfDocument readGltfDocument(const std::string& path);

// The same from memory. `name` begins the errors; URIs are relative to `folder`.
GltfDocument parseGltfDocument(std::span<const unsigned char> bytes, const std::string& name, const std::filesystem::path& folder);

// The bytes of a buffer view. Throws Error naming the document if there is no view with this index.
std::span<const unsigned char> viewBytes(const GltfDocument& document, size_t view);

// Number of elements of an accessor.
size_t accessorCount(const GltfDocument& document, size_t accessor);

// An accessor's elements as floats, `components` per element; normalised integers are mapped to 0..1 or -1..1. Throws
// Error naming the document if it has another number of components, or more elements than a file of this size can mean.
std::vector<float> readAccessor(const GltfDocument& document, size_t accessor, int components);

// An accessor's elements as integers. Throws Error naming the document unless they are scalars of an unsigned type.
std::vector<uint32_t> readIndices(const GltfDocument& document, size_t accessor);

// Adds a node to the default scene, and one with a camera.
void addNode(Json& json, Json node);
void addCamera(Json& json, const Camera& view);

// The scene of a document that was read, or made.
Scene sceneOf(GltfDocument document);

// The first accessor of this name: what no object refers to is found by it, so that programs that know nothing of it leave the rest alone.
std::optional<size_t> findAccessor(const Json& json, const char* name);

// Takes the names of all accessors that are called so away, and returns their indices.
std::set<size_t> takeNames(Json& json, std::span<const char* const> names);

// A new accessor of chosen elements of another: its JSON without the place of its bytes, and the bytes, each element
// padded to a multiple of four. `from`: the index of each element to take. Throws Error if one is out of range.
struct GatheredAccessor {
    Json members;
    Bytes bytes;
    size_t stride = 0;  // bytes from one element to the next
};
GatheredAccessor gatherAccessor(const GltfDocument& document, size_t accessor, std::span<const uint32_t> from);

// The rest is for runtime/asset/gltf_*.cpp alone.

// The JSON chunk and, for a .glb, the binary one.
struct GltfContainer {
    std::span<const unsigned char> json, binary;
    bool isBinary = false;
    bool hasMore = false;  // chunks of other kinds follow
};
GltfContainer splitContainer(std::span<const unsigned char> bytes, const std::string& name);
// Throws Error unless all JSON that is read later has the right type and every index is in range.
void checkStructure(const Json& json, const std::string& name);
// Throws Error unless every accessor lies within its view.
void checkAccessors(const GltfDocument& document);
// The target of a URI: data that it contains, or an ordinary file in the document's folder or below.
struct UriSource {
    std::string uri;
    std::filesystem::path file;  // canonical; empty if the URI is data or there is no such file
    bool isData() const { return uri.starts_with("data:"); }
};
// Throws Error naming the URI where it leads anywhere else.
UriSource resolveUri(const std::string& uri, const std::filesystem::path& folder, const std::string& name);
// Its bytes; nullopt if there is no such file. Throws Error naming the URI if it cannot be read or is not of `length` bytes.
std::optional<Bytes> readUri(const UriSource& source, std::optional<size_t> length, const std::string& name);
// Removes second, compressed copies of the same data in optional extensions: Draco, KHR_meshopt_compression.
void dropAlternatives(Json& json);
// Replaces each compressed view by a plain one with a buffer of its own.
void decodeMeshopt(GltfDocument& document);
// Replaces EXT_mesh_gpu_instancing by child nodes, since each instance sees its own sky.
void expandInstancing(GltfDocument& document);

// The ordinary files that a document's buffers and images stand in. `folder`: its own.
std::vector<std::filesystem::path> filesOf(const GltfDocument& document, const std::filesystem::path& folder);

// The non-negative integer `object[key]`, or `fallback` if there is none. Call it only after checkStructure.
inline size_t unsignedOr(const Json& object, const char* key, size_t fallback) {
    const auto found = object.find(key);
    return found == object.end() ? fallback : found->get<size_t>();
}
// The array or object `object[key]`, or an empty array.
inline const Json& listOf(const Json& object, const char* key) {
    static const Json none = Json::array();
    const auto found = object.find(key);
    return found == object.end() ? none : *found;
}

}  // namespace apertura
