// The contents of buffer views and accessors of a glTF document.
#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include "apertura/runtime/asset/gltf_document.h"
#include "apertura/runtime/asset/scene.h"

namespace apertura {
namespace {

// Limit of elements of an accessor without a view. A harmless one has sparse values, some of which are in the file.
constexpr size_t kZerosAByte = 16, kFewZeros = 65536;
// Limit of nodes that instances become. Each instance takes some bytes of an accessor.
constexpr double kFewInstances = 65536, kInstancesAByte = 1, kBytesAnInstance = 2000;

// The layout of elements in a buffer.
struct Layout {
    std::span<const unsigned char> bytes;  // of the view, starting at the first element
    size_t stride = 0;                     // bytes from one element to the next

    const unsigned char* element(size_t i) const { return bytes.data() + i * stride; }
};

size_t componentSize(int type) { return type == kByte || type == kUnsignedByte ? 1 : type == kShort || type == kUnsignedShort ? 2 : 4; }

// Rows and columns of a type. Columns of matrices start at multiples of four bytes.
std::pair<size_t, size_t> shapeOf(const Json& accessor) {
    static const std::map<std::string, std::pair<size_t, size_t>> shapes{
        {"SCALAR", {1, 1}}, {"VEC2", {2, 1}}, {"VEC3", {3, 1}}, {"VEC4", {4, 1}}, {"MAT2", {2, 2}}, {"MAT3", {3, 3}}, {"MAT4", {4, 4}}};
    return shapes.at(accessor["type"].get_ref<const std::string&>());
}

size_t sizeOf(const Json& accessor) {
    const auto [rows, columns] = shapeOf(accessor);
    const size_t column = rows * componentSize(accessor["componentType"].get<int>());
    return columns == 1 ? column : columns * ((column + 3) / 4 * 4);
}

// `count` elements of `element` bytes in a view from `offset` on. Throws Error unless they lie inside it.
Layout layoutOf(const GltfDocument& document, const std::string& where, size_t view, size_t offset, size_t count, size_t element,
                bool strided) {
    const std::span<const unsigned char> bytes = viewBytes(document, view);
    const size_t given = strided ? unsignedOr(document.json["bufferViews"][view], "byteStride", 0) : 0;
    const size_t stride = given ? given : element;
    const bool inside = offset <= bytes.size() && stride >= element
                     && (count == 0 || (element <= bytes.size() - offset && count - 1 <= (bytes.size() - offset - element) / stride));
    if (!inside) throw Error(where + " reaches outside its buffer view");
    return {bytes.subspan(offset), stride};
}

// An accessor whose ranges are checked. Without a view its elements are zeros; sparse values then replace some of them.
struct Elements {
    size_t count = 0, size = 0;  // bytes per element
    std::optional<Layout> dense;
    size_t sparseCount = 0, indexSize = 0;
    Layout sparseIndices, sparseValues;
};

Elements elementsOf(const GltfDocument& document, size_t index) {
    const Json& accessor = document.json["accessors"].at(index);
    const std::string where = document.name + ": accessor " + std::to_string(index);
    Elements out;
    out.count = accessor["count"].get<size_t>();
    out.size = sizeOf(accessor);
    if (accessor.contains("bufferView"))
        out.dense = layoutOf(document, where, accessor["bufferView"].get<size_t>(), unsignedOr(accessor, "byteOffset", 0), out.count,
                             out.size, true);
    const auto sparse = accessor.find("sparse");
    if (sparse == accessor.end()) return out;
    out.sparseCount = sparse->at("count").get<size_t>();
    if (out.sparseCount > out.count) throw Error(where + " has more sparse elements than elements");
    const Json &indices = sparse->at("indices"), &values = sparse->at("values");
    out.indexSize = componentSize(indices["componentType"].get<int>());
    out.sparseIndices = layoutOf(document, where, indices["bufferView"].get<size_t>(), unsignedOr(indices, "byteOffset", 0),
                                 out.sparseCount, out.indexSize, false);
    out.sparseValues = layoutOf(document, where, values["bufferView"].get<size_t>(), unsignedOr(values, "byteOffset", 0), out.sparseCount,
                                out.size, false);
    return out;
}

size_t bytesInBuffers(const GltfDocument& document) {
    std::set<const Bytes*> distinct;
    size_t sum = 0;
    for (const SharedBytes& buffer : document.buffers)
        if (distinct.insert(buffer.get()).second) sum += buffer->size();
    return sum;
}

// The elements, tightly packed.
Bytes elementBytes(const GltfDocument& document, size_t index) {
    const Elements elements = elementsOf(document, index);
    const std::string where = document.name + ": accessor " + std::to_string(index);
    // The bytes of a view limit its elements. Without a view they are zeros, and a file can claim any number of them.
    if (!elements.dense && elements.count > kZerosAByte * bytesInBuffers(document) + kFewZeros)
        throw Error(where + " has too many elements");
    Bytes out(elements.count * elements.size);
    if (elements.dense)
        for (size_t i = 0; i < elements.count; ++i) std::memcpy(&out[i * elements.size], elements.dense->element(i), elements.size);
    for (size_t i = 0; i < elements.sparseCount; ++i) {
        uint32_t at = 0;
        std::memcpy(&at, elements.sparseIndices.element(i), elements.indexSize);  // little-endian, as glTF is
        if (at >= elements.count) throw Error(where + " has a sparse index out of range");
        std::memcpy(&out[at * elements.size], elements.sparseValues.element(i), elements.size);
    }
    return out;
}

float toFloat(const unsigned char* bytes, int type, bool normalized) {
    auto load = [bytes](auto value) {
        std::memcpy(&value, bytes, sizeof value);
        return float(value);
    };
    auto scaled = [&](float value, float top) { return normalized ? std::max(value / top, -1.0f) : value; };
    switch (type) {
        case kByte: return scaled(load(int8_t{}), 127);
        case kUnsignedByte: return scaled(load(uint8_t{}), 255);
        case kShort: return scaled(load(int16_t{}), 32767);
        case kUnsignedShort: return scaled(load(uint16_t{}), 65535);
        case kUnsignedInt: return load(uint32_t{});
        default: return load(float{});
    }
}

void forgetExtension(Json& json, const char* name) {
    for (const char* key : {"extensionsUsed", "extensionsRequired"}) {
        if (!json.contains(key)) continue;
        Json kept = Json::array();
        for (const Json& entry : json[key])
            if (entry != name) kept.push_back(entry);
        if (kept.empty())
            json.erase(key);  // glTF allows no empty list
        else
            json[key] = std::move(kept);
    }
}

void eraseExtension(Json& holder, const char* name) {
    if (!holder.contains("extensions")) return;
    holder["extensions"].erase(name);
    if (holder["extensions"].empty()) holder.erase("extensions");
}

// Upper bound for the bytes that one byte of EXT_meshopt_compression decodes to. Vertices take at least two bits for a
// group of sixteen equal bytes, triangles a byte for three indices, sequences a byte for one.
size_t largestRatio(const std::string& mode) { return mode == "ATTRIBUTES" ? 64 : mode == "TRIANGLES" ? 12 : 4; }

// Adds one attribute of the instances to the nodes: part of their transform, or an application's own, as extras.
void addInstanceValues(const GltfDocument& document, const std::string& attribute, size_t accessor, std::vector<Json>& children) {
    static const std::map<std::string, std::pair<const char*, size_t>> transforms{
        {"TRANSLATION", {"translation", 3}}, {"ROTATION", {"rotation", 4}}, {"SCALE", {"scale", 3}}};
    const auto found = transforms.find(attribute);
    const bool transform = found != transforms.end();
    const auto [rows, columns] = shapeOf(document.json["accessors"][accessor]);
    if (!transform && columns != 1) return;
    const size_t size = transform ? found->second.second : rows;
    const std::vector<float> values = readAccessor(document, accessor, int(size));
    if (transform && !std::all_of(values.begin(), values.end(), [](float x) { return std::isfinite(x); }))
        throw Error(document.name + ": an instance's " + found->second.first + " is not finite");
    for (size_t i = 0; i < children.size(); ++i) {
        const Json own(std::vector<float>(values.begin() + ptrdiff_t(i * size), values.begin() + ptrdiff_t((i + 1) * size)));
        if (transform)
            children[i][found->second.first] = own;
        else
            children[i]["extras"][attribute] = size == 1 ? own[0] : own;
    }
}

Bytes decodeView(const GltfDocument& document, const Json& packed, const std::string& where) {
    const Error broken(where + " is compressed, and damaged");
    const Bytes& buffer = *document.buffers[packed["buffer"].get<size_t>()];
    const size_t offset = unsignedOr(packed, "byteOffset", 0), length = packed["byteLength"].get<size_t>();
    const size_t stride = packed["byteStride"].get<size_t>(), count = packed["count"].get<size_t>();
    const std::string mode = packed.value("mode", ""), filter = packed.value("filter", "NONE");
    if (offset > buffer.size() || length > buffer.size() - offset) throw Error(where + " reaches outside its buffer");
    if (stride == 0 || stride > 256 || count == 0 || count > largestRatio(mode) * length / stride) throw broken;
    Bytes out(count * stride);
    const unsigned char* source = buffer.data() + offset;
    int status = -1;
    if (mode == "ATTRIBUTES" && stride % 4 == 0)
        status = meshopt_decodeVertexBuffer(out.data(), count, stride, source, length);
    else if (mode == "TRIANGLES" && count % 3 == 0 && (stride == 2 || stride == 4))
        status = meshopt_decodeIndexBuffer(out.data(), count, stride, source, length);
    else if (mode == "INDICES" && (stride == 2 || stride == 4))
        status = meshopt_decodeIndexSequence(out.data(), count, stride, source, length);
    if (status != 0) throw broken;
    if (filter == "OCTAHEDRAL" && (stride == 4 || stride == 8))
        meshopt_decodeFilterOct(out.data(), count, stride);
    else if (filter == "QUATERNION" && stride == 8)
        meshopt_decodeFilterQuat(out.data(), count, stride);
    else if (filter == "EXPONENTIAL" && stride % 4 == 0)
        meshopt_decodeFilterExp(out.data(), count, stride);
    else if (filter != "NONE")
        throw broken;
    return out;
}

}  // namespace

std::span<const unsigned char> viewBytes(const GltfDocument& document, size_t index) {
    const Json& views = listOf(document.json, "bufferViews");
    if (index >= views.size()) throw Error(document.name + ": buffer view " + std::to_string(index) + " does not exist");
    const std::span<const unsigned char> buffer(*document.buffers[views[index]["buffer"].get<size_t>()]);
    return buffer.subspan(unsignedOr(views[index], "byteOffset", 0), views[index]["byteLength"].get<size_t>());
}

size_t accessorCount(const GltfDocument& document, size_t accessor) {
    return document.json["accessors"].at(accessor)["count"].get<size_t>();
}

void checkAccessors(const GltfDocument& document) {
    const size_t count = listOf(document.json, "accessors").size();
    for (size_t i = 0; i < count; ++i) elementsOf(document, i);
}

std::vector<float> readAccessor(const GltfDocument& document, size_t index, int components) {
    const Json& accessor = document.json["accessors"].at(index);
    const auto [rows, columns] = shapeOf(accessor);
    if (columns != 1 || rows != size_t(components))
        throw Error(document.name + ": accessor " + std::to_string(index) + " does not have " + std::to_string(components) + " components");
    const int type = accessor["componentType"].get<int>();
    const bool normalized = accessor.value("normalized", false);
    const Bytes bytes = elementBytes(document, index);
    const size_t size = componentSize(type);
    std::vector<float> out(bytes.size() / size);
    for (size_t i = 0; i < out.size(); ++i) out[i] = toFloat(&bytes[i * size], type, normalized);
    return out;
}

std::vector<uint32_t> readIndices(const GltfDocument& document, size_t index) {
    const Json& accessor = document.json["accessors"].at(index);
    const int type = accessor["componentType"].get<int>();
    if (accessor["type"] != "SCALAR" || (type != kUnsignedByte && type != kUnsignedShort && type != kUnsignedInt))
        throw Error(document.name + ": accessor " + std::to_string(index) + " holds no indices: they are whole numbers without a sign");
    const Bytes bytes = elementBytes(document, index);
    const size_t size = componentSize(type);
    std::vector<uint32_t> out(bytes.size() / size, 0);
    for (size_t i = 0; i < out.size(); ++i) std::memcpy(&out[i], &bytes[i * size], size);
    return out;
}

GatheredAccessor gatherAccessor(const GltfDocument& document, size_t index, std::span<const uint32_t> from) {
    const Json& accessor = document.json["accessors"].at(index);
    const Bytes given = elementBytes(document, index);
    const size_t size = sizeOf(accessor);
    GatheredAccessor out{accessor, {}, (size + 3) / 4 * 4};
    for (const char* key : {"bufferView", "byteOffset", "sparse"}) out.members.erase(key);
    out.members["count"] = from.size();
    out.bytes.resize(from.size() * out.stride);
    for (size_t i = 0; i < from.size(); ++i) {
        if (from[i] >= given.size() / size)
            throw Error(document.name + ": accessor " + std::to_string(index) + " does not have one element a vertex");
        std::memcpy(&out.bytes[i * out.stride], &given[from[i] * size], size);
    }
    if (!accessor.contains("min") && !accessor.contains("max")) return out;
    // glTF states min and max of the components before normalisation.
    const int type = accessor["componentType"].get<int>();
    const size_t part = componentSize(type), parts = size / part;
    std::vector<double> low(parts, 1e300), high(parts, -1e300);
    for (size_t i = 0; i < from.size(); ++i)
        for (size_t c = 0; c < parts; ++c) {
            const double value = toFloat(&out.bytes[i * out.stride + c * part], type, false);
            low[c] = std::min(low[c], value), high[c] = std::max(high[c], value);
        }
    const bool plain = shapeOf(accessor).second == 1 && !from.empty();
    for (const char* key : {"min", "max"}) out.members.erase(key);
    if (plain) out.members["min"] = low, out.members["max"] = high;
    return out;
}

void dropAlternatives(Json& json) {
    const char *meshopt = "KHR_meshopt_compression", *draco = "KHR_draco_mesh_compression";
    for (const char* key : {"buffers", "bufferViews"})
        if (json.contains(key))
            for (Json& entry : json[key]) eraseExtension(entry, meshopt);
    if (json.contains("meshes"))
        for (Json& mesh : json["meshes"])
            if (mesh.contains("primitives"))
                for (Json& primitive : mesh["primitives"]) eraseExtension(primitive, draco);
    for (const char* name : {meshopt, draco}) forgetExtension(json, name);
}

void decodeMeshopt(GltfDocument& document) {
    const char* name = "EXT_meshopt_compression";
    if (!document.json.contains("bufferViews")) return;
    const size_t most = 64 * bytesInBuffers(document);
    size_t total = 0;
    Json& views = document.json["bufferViews"];
    for (size_t i = 0; i < views.size(); ++i) {
        const Json extensions = listOf(views[i], "extensions");
        if (!extensions.contains(name)) continue;
        const std::string where = document.name + ": buffer view " + std::to_string(i);
        auto plain = std::make_shared<const Bytes>(decodeView(document, extensions[name], where));
        total += plain->size();
        if (total > most) throw Error(where + ": compressed views decode to more than their bytes can hold");
        views[i]["buffer"] = document.buffers.size();
        views[i]["byteLength"] = plain->size();
        views[i].erase("byteOffset");
        eraseExtension(views[i], name);
        document.json["buffers"].push_back({{"byteLength", plain->size()}});
        document.buffers.push_back(std::move(plain));
        document.decodedViews.insert(i);
    }
    for (Json& buffer : document.json["buffers"]) eraseExtension(buffer, name);
    forgetExtension(document.json, name);
}

void expandInstancing(GltfDocument& document) {
    const char* name = "EXT_mesh_gpu_instancing";
    if (!document.json.contains("nodes")) return;
    Json& nodes = document.json["nodes"];
    const size_t given = nodes.size();
    // The number of instances of a node: that of the elements of each of its attributes.
    auto attributesOf = [&](const Json& node) {
        return listOf(node, "extensions").contains(name) ? node["extensions"][name]["attributes"] : Json();
    };
    auto countOf = [&](const Json& attributes) {
        std::optional<size_t> count;
        for (const Json& accessor : attributes) {
            const size_t here = accessorCount(document, accessor.get<size_t>());
            if (count && here != *count) throw Error(document.name + ": instancing attributes differ in length");
            count = here;
        }
        return count.value_or(0);
    };
    // Instances are counted before nodes are allocated.
    size_t instances = 0;
    for (const Json& node : nodes)
        if (node.contains("mesh")) instances += countOf(attributesOf(node));
    requireMemory(document.name, std::to_string(instances) + " instances", double(instances) * kBytesAnInstance);
    Budget(document, "its instances", kFewInstances, kInstancesAByte).spend(double(instances));
    for (size_t n = 0; n < given; ++n) {
        const Json attributes = attributesOf(nodes[n]);
        if (attributes.is_null()) continue;
        eraseExtension(nodes[n], name);
        if (!nodes[n].contains("mesh")) continue;
        const size_t count = countOf(attributes);
        std::vector<Json> children(count, Json::object());
        for (const char* key : {"mesh", "skin", "weights"})
            if (nodes[n].contains(key)) {
                for (Json& child : children) child[key] = nodes[n][key];
                nodes[n].erase(key);
            }
        for (const auto& attribute : attributes.items())
            addInstanceValues(document, attribute.key(), attribute.value().get<size_t>(), children);
        for (Json& child : children) {
            nodes[n]["children"].push_back(nodes.size());
            nodes.push_back(std::move(child));
        }
    }
    forgetExtension(document.json, name);
}

std::optional<size_t> findAccessor(const Json& json, const char* name) {
    const Json& accessors = listOf(json, "accessors");
    for (size_t i = 0; i < accessors.size(); ++i)
        if (accessors[i].value("name", Json()) == name) return i;
    return std::nullopt;
}

std::set<size_t> takeNames(Json& json, std::span<const char* const> names) {
    std::set<size_t> out;
    for (size_t i = 0; i < listOf(json, "accessors").size(); ++i) {
        Json& accessor = json["accessors"][i];
        const Json name = accessor.value("name", Json());
        if (std::none_of(names.begin(), names.end(), [&](const char* own) { return name == own; })) continue;
        accessor.erase("name");
        out.insert(i);
    }
    return out;
}

}  // namespace apertura
