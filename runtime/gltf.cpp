#include "runtime/gltf.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

namespace apertura {
namespace {

using tinygltf::Model;
using tinygltf::Value;

constexpr size_t kLargestDecoded = size_t(1) << 28;  // bytes of one decoded buffer view
constexpr int kDeepest = 200;                        // nested arrays and objects; the parsers recurse

// Images stay the bytes they are in the file.
bool keepImage(tinygltf::Image* image, int, std::string*, std::string*, int, int, const unsigned char* bytes,
               int size, void*) {
    image->image.assign(bytes, bytes + size);
    image->as_is = true;
    return true;
}

std::string oneLine(std::string text) {
    while (!text.empty() && text.back() == '\n') text.pop_back();
    if (const size_t end = text.find('\n'); end != std::string::npos) text.resize(end);
    return text;
}

using Json = nlohmann::json;

void requireKnownExtensions(const Json& document, const std::string& path) {
    static const std::set<std::string> known{
        "KHR_mesh_quantization", "KHR_texture_transform", "EXT_meshopt_compression", "EXT_mesh_gpu_instancing",
        "KHR_lights_punctual", "KHR_texture_basisu", "EXT_texture_webp"};
    const Json required = document.is_object() ? document.value("extensionsRequired", Json::array()) : Json::array();
    for (const Json& name : required)
        if (name.is_string() && !known.contains(name.get<std::string>())
            && !name.get<std::string>().starts_with("KHR_materials_"))
            throw Error(path + ": needs the extension " + name.get<std::string>() + ", which is not supported");
}

// The buffers that EXT_meshopt_compression leaves empty for readers that know it: tinygltf does not, and
// gets zeros. True where there was one.
bool fillFallbackBuffers(Json& document) {
    bool changed = false;
    if (!document.is_object() || !document.contains("buffers") || !document["buffers"].is_array()) return false;
    for (Json& buffer : document["buffers"]) {
        if (!buffer.is_object() || buffer.contains("uri") || !buffer.contains("extensions")) continue;
        const Json& extensions = buffer["extensions"];
        if (!extensions.is_object() || !extensions.contains("EXT_meshopt_compression")) continue;
        const uint64_t size = buffer.value("byteLength", uint64_t(0));
        if (size > kLargestDecoded) continue;
        std::string zeros((size + 2) / 3 * 4, 'A');
        for (size_t i = 0; i < (3 - size % 3) % 3; ++i) zeros[zeros.size() - 1 - i] = '=';
        buffer["uri"] = "data:application/octet-stream;base64," + zeros;
        changed = true;
    }
    return changed;
}

// Whether JSON text nests deeper than the parsers can follow.
bool nestsTooDeep(const unsigned char* text, size_t size) {
    int depth = 0;
    bool quoted = false;
    for (size_t i = 0; i < size; ++i) {
        const unsigned char c = text[i];
        if (quoted) {
            if (c == '\\') ++i;
            quoted = c != '"';
        } else if (c == '"') {
            quoted = true;
        } else if (c == '{' || c == '[') {
            if (++depth > kDeepest) return true;
        } else if (c == '}' || c == ']') {
            --depth;
        }
    }
    return false;
}

uint32_t word(const std::vector<unsigned char>& bytes, size_t at) {
    uint32_t value = 0;
    std::memcpy(&value, &bytes[at], 4);  // little-endian, as glTF is
    return value;
}

Model parse(const std::string& path, std::string& json) {
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored)) throw Error(path + ": is a folder");
    std::ifstream in(path, std::ios::binary);
    if (!in) throw Error(path + ": cannot be opened: " + std::strerror(errno));
    std::vector<unsigned char> bytes((std::istreambuf_iterator<char>(in)), {});
    if (bytes.empty()) throw Error(path + ": the file is empty");
    const auto first = std::find_if(bytes.begin(), bytes.end(), [](unsigned char c) { return !std::isspace(c); });
    const bool text = first != bytes.end() && (*first == '{' || *first == '[' || *first == 0xef);  // JSON, or a byte order mark
    if (!text && bytes[0] != 'g') throw Error(path + ": not a glTF file");
    if (bytes.size() > std::numeric_limits<uint32_t>::max()) throw Error(path + ": larger than 4 GiB");

    tinygltf::TinyGLTF loader;
    loader.SetImageLoader(keepImage, nullptr);
    Model model;
    std::string error, warning;
    const std::string folder = std::filesystem::path(path).parent_path().string();
    bool ok = false;
    try {
        bytes = editGltfJson(std::move(bytes), path, [&](Json& document) {
            requireKnownExtensions(document, path);
            json = document.dump();
            return fillFallbackBuffers(document);
        });
        const auto size = uint32_t(bytes.size());
        if (std::memcmp(bytes.data(), "glTF", 4) == 0)
            ok = loader.LoadBinaryFromMemory(&model, &error, &warning, bytes.data(), size, folder);
        else
            ok = loader.LoadASCIIFromString(&model, &error, &warning, reinterpret_cast<const char*>(bytes.data()), size,
                                            folder);
    } catch (const Error&) {
        throw;
    } catch (const std::exception& e) {
        throw Error(path + ": not a valid glTF file: " + oneLine(e.what()));
    }
    if (!ok) throw Error(path + ": not a valid glTF file: " + oneLine(error.empty() ? "no reason given" : error));
    return model;
}

void forget(std::vector<std::string>& names, const std::string& name) { std::erase(names, name); }

size_t unsignedField(const Value& v, const char* key) {
    return v.Has(key) && v.Get(key).IsNumber() ? size_t(std::max(v.Get(key).GetNumberAsDouble(), 0.0)) : 0;
}

// Replaces each view that EXT_meshopt_compression packs by a plain one with a buffer of its own.
void decodeMeshopt(Model& model, const std::string& path) {
    const char* extension = "EXT_meshopt_compression";
    for (tinygltf::BufferView& view : model.bufferViews) {
        const auto found = view.extensions.find(extension);
        if (found == view.extensions.end()) continue;
        const Value& packed = found->second;
        const size_t buffer = unsignedField(packed, "buffer"), offset = unsignedField(packed, "byteOffset");
        const size_t length = unsignedField(packed, "byteLength"), stride = unsignedField(packed, "byteStride");
        const size_t count = unsignedField(packed, "count");
        auto text = [&](const char* key) { return packed.Has(key) ? packed.Get(key).Get<std::string>() : std::string(); };
        const std::string mode = text("mode"), filter = text("filter");
        const Error broken(path + ": a compressed buffer view is damaged");
        const size_t available = buffer < model.buffers.size() ? model.buffers[buffer].data.size() : 0;
        if (stride == 0 || stride > 256 || count > kLargestDecoded / stride || offset > available
            || length > available - offset)
            throw broken;
        const unsigned char* source = model.buffers[buffer].data.data() + offset;
        tinygltf::Buffer plain;
        plain.data.resize(count * stride);
        int status = -1;
        if (mode == "ATTRIBUTES" && stride % 4 == 0)
            status = meshopt_decodeVertexBuffer(plain.data.data(), count, stride, source, length);
        else if (mode == "TRIANGLES" && count % 3 == 0 && (stride == 2 || stride == 4))
            status = meshopt_decodeIndexBuffer(plain.data.data(), count, stride, source, length);
        else if (mode == "INDICES" && (stride == 2 || stride == 4))
            status = meshopt_decodeIndexSequence(plain.data.data(), count, stride, source, length);
        if (status != 0) throw broken;
        if (filter == "OCTAHEDRAL" && (stride == 4 || stride == 8))
            meshopt_decodeFilterOct(plain.data.data(), count, stride);
        else if (filter == "QUATERNION" && stride == 8)
            meshopt_decodeFilterQuat(plain.data.data(), count, stride);
        else if (filter == "EXPONENTIAL" && stride % 4 == 0)
            meshopt_decodeFilterExp(plain.data.data(), count, stride);
        else if (!filter.empty() && filter != "NONE")
            throw broken;
        view.buffer = int(model.buffers.size());
        view.byteOffset = 0;
        view.byteLength = plain.data.size();
        view.extensions.erase(found);
        model.buffers.push_back(std::move(plain));
    }
    for (tinygltf::Buffer& buffer : model.buffers) buffer.extensions.erase(extension);
    forget(model.extensionsUsed, extension);
    forget(model.extensionsRequired, extension);
}

// Spells EXT_mesh_gpu_instancing out as child nodes: each instance sees a sky of its own.
void expandInstancing(Model& model, const std::string& path) {
    const char* extension = "EXT_mesh_gpu_instancing";
    const size_t nodes = model.nodes.size();
    for (size_t n = 0; n < nodes; ++n) {
        const auto found = model.nodes[n].extensions.find(extension);
        if (found == model.nodes[n].extensions.end()) continue;
        const Value attributes = found->second.Has("attributes") ? found->second.Get("attributes") : Value();
        model.nodes[n].extensions.erase(found);
        size_t count = 0;
        auto read = [&](const char* key, int components) {
            std::vector<float> values;
            if (attributes.IsObject() && attributes.Has(key)) {
                values = readAccessor(model, attributes.Get(key).GetNumberAsInt(), components, path);
                const size_t here = values.size() / components;
                if (count != 0 && here != count) throw Error(path + ": instancing attributes differ in length");
                count = here;
            }
            return values;
        };
        const auto translations = read("TRANSLATION", 3), rotations = read("ROTATION", 4), scales = read("SCALE", 3);
        if (model.nodes[n].mesh < 0) continue;
        for (size_t i = 0; i < count; ++i) {
            tinygltf::Node child;
            child.mesh = model.nodes[n].mesh;
            if (!translations.empty()) child.translation.assign(&translations[3 * i], &translations[3 * i] + 3);
            if (!rotations.empty()) child.rotation.assign(&rotations[4 * i], &rotations[4 * i] + 4);
            if (!scales.empty()) child.scale.assign(&scales[3 * i], &scales[3 * i] + 3);
            model.nodes[n].children.push_back(int(model.nodes.size()));
            model.nodes.push_back(child);
        }
        model.nodes[n].mesh = -1;
    }
    forget(model.extensionsUsed, extension);
    forget(model.extensionsRequired, extension);
}

glm::dmat4 localTransform(const tinygltf::Node& node) {
    glm::dmat4 m(1);
    if (node.matrix.size() == 16) {
        std::copy(node.matrix.begin(), node.matrix.end(), &m[0][0]);
        return m;
    }
    if (node.translation.size() == 3)
        m[3] = glm::dvec4(node.translation[0], node.translation[1], node.translation[2], 1);
    if (node.rotation.size() == 4)
        m *= glm::mat4_cast(
            glm::normalize(glm::dquat(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2])));
    if (node.scale.size() == 3)
        for (int c = 0; c < 3; ++c) m[c] *= node.scale[c];
    return m;
}

std::vector<uint32_t> readIndices(const Model& model, int accessor, const std::string& path) {
    if (accessor < 0 || size_t(accessor) >= model.accessors.size())
        throw Error(path + ": a primitive's index accessor does not exist");
    const tinygltf::Accessor& a = model.accessors[accessor];
    // Floats hold indices exactly below 2^24 only: 32-bit indices are read as they are.
    if (a.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT || a.sparse.isSparse) {
        const std::vector<float> values = readAccessor(model, accessor, 1, path);
        return {values.begin(), values.end()};
    }
    readAccessor(model, accessor, 1, path);  // the checks
    const tinygltf::BufferView& view = model.bufferViews[a.bufferView];
    const unsigned char* data = model.buffers[view.buffer].data.data() + view.byteOffset + a.byteOffset;
    const size_t stride = view.byteStride ? view.byteStride : 4;
    std::vector<uint32_t> out(a.count);
    for (size_t i = 0; i < out.size(); ++i) std::memcpy(&out[i], data + i * stride, 4);
    return out;
}

std::vector<std::array<uint32_t, 3>> triangulate(const std::vector<uint32_t>& indices, int mode) {
    std::vector<std::array<uint32_t, 3>> out;
    if (mode == TINYGLTF_MODE_TRIANGLES)
        for (size_t i = 0; i + 2 < indices.size(); i += 3) out.push_back({indices[i], indices[i + 1], indices[i + 2]});
    else
        for (size_t i = 0; i + 2 < indices.size(); ++i) {
            if (mode == TINYGLTF_MODE_TRIANGLE_FAN)
                out.push_back({indices[i + 1], indices[i + 2], indices[0]});
            else
                out.push_back({indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]});
        }
    return out;
}

std::vector<glm::vec3> readVectors(const Model& model, int accessor, const std::string& path) {
    const std::vector<float> values = readAccessor(model, accessor, 3, path);
    std::vector<glm::vec3> out(values.size() / 3);
    std::memcpy(out.data(), values.data(), values.size() * sizeof(float));
    return out;
}

// The primitive as a Surface; without triangles where it draws points or lines.
Surface readPrimitive(const Model& model, const tinygltf::Primitive& primitive, const std::string& path) {
    Surface surface;
    const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
    const auto position = primitive.attributes.find("POSITION");
    if (mode < TINYGLTF_MODE_TRIANGLES || position == primitive.attributes.end()) return surface;
    if (primitive.material >= 0 && size_t(primitive.material) < model.materials.size()) surface.twoSided = model.materials[size_t(primitive.material)].doubleSided;
    surface.positions = readVectors(model, position->second, path);
    std::vector<uint32_t> indices;
    if (primitive.indices >= 0) {
        indices = readIndices(model, primitive.indices, path);
    } else {
        indices.resize(surface.positions.size());
        for (size_t i = 0; i < indices.size(); ++i) indices[i] = uint32_t(i);
    }
    surface.triangles = triangulate(indices, mode);
    for (const auto& [name, accessor] : primitive.attributes)
        if (accessor < 0 || size_t(accessor) >= model.accessors.size()
            || model.accessors[accessor].count != surface.positions.size())
            throw Error(path + ": attribute " + name + " does not have one element a vertex");
    for (const auto& triangle : surface.triangles)
        for (uint32_t index : triangle)
            if (index >= surface.positions.size())
                throw Error(path + ": triangle index " + std::to_string(index) + " is out of range, there are "
                            + std::to_string(surface.positions.size()) + " vertices");
    if (const auto normal = primitive.attributes.find("NORMAL"); normal != primitive.attributes.end()) {
        surface.normals = readVectors(model, normal->second, path);
        for (glm::vec3& n : surface.normals) {
            const float length = glm::length(n);
            n = length > 1e-12f && std::isfinite(length) ? n / length : glm::vec3(0, 1, 0);
        }
    } else {
        makeNormals(surface);
    }
    return surface;
}

// Walks the scene's nodes; glTF forbids cycles and files have them all the same.
class Walker {
public:
    Walker(Scene& scene, const Model& model) : scene_(scene), model_(model), open_(model.nodes.size()), seen_(model.nodes.size()) {
        first_.resize(model.meshes.size(), -1);
    }

    void visit(int index, const glm::dmat4& parent, int depth = 0) {
        const auto& path = scene_.name;
        if (index < 0 || size_t(index) >= model_.nodes.size())
            throw Error(path + ": node " + std::to_string(index) + " does not exist");
        if (open_[index]) throw Error(path + ": node " + std::to_string(index) + " is its own ancestor");
        if (seen_[index]) throw Error(path + ": node " + std::to_string(index) + " has two parents");
        seen_[index] = true;
        if (depth > 1000) throw Error(path + ": nodes are nested more than 1000 deep");
        open_[index] = true;
        const tinygltf::Node& node = model_.nodes[index];
        const glm::dmat4 world = parent * localTransform(node);
        if (node.mesh >= 0) addMesh(index, node.mesh, world);
        if (node.camera >= 0 && !scene_.camera) addCamera(node.camera, world);
        for (int child : node.children) visit(child, world, depth + 1);
        open_[index] = false;
    }

private:
    void addMesh(int node, int mesh, const glm::dmat4& world) {
        if (size_t(mesh) >= model_.meshes.size())
            throw Error(scene_.name + ": mesh " + std::to_string(mesh) + " does not exist");
        const auto& primitives = model_.meshes[mesh].primitives;
        if (first_[mesh] < 0) {
            first_[mesh] = int(scene_.surfaces.size());
            for (const auto& primitive : primitives)
                scene_.surfaces.push_back(readPrimitive(model_, primitive, scene_.name));
        }
        for (size_t p = 0; p < primitives.size(); ++p)
            if (!scene_.surfaces[first_[mesh] + p].triangles.empty())
                scene_.instances.push_back({first_[mesh] + int(p), glm::mat4(world), node, int(p)});
    }

    void addCamera(int index, const glm::dmat4& world) {
        if (size_t(index) >= model_.cameras.size()) return;
        const tinygltf::Camera& camera = model_.cameras[index];
        if (camera.type != "perspective" || !(camera.perspective.yfov > 0)) return;
        const glm::dvec3 eye(world[3]), forward = -glm::dvec3(world[2]);
        const double length = glm::length(forward);
        if (!(length > 0) || !std::isfinite(length)) return;
        scene_.camera = Camera{glm::vec3(eye), glm::vec3(eye + forward / length), float(camera.perspective.yfov)};
    }

    Scene& scene_;
    const Model& model_;
    std::vector<bool> open_, seen_;
    std::vector<int> first_;
};

}  // namespace

std::vector<float> readAccessor(const Model& model, int index, int components, const std::string& path) {
    const Error missing(path + ": an accessor, buffer view or buffer does not exist");
    if (index < 0 || size_t(index) >= model.accessors.size()) throw missing;
    const tinygltf::Accessor& a = model.accessors[index];
    const std::string where = path + ": accessor " + std::to_string(index);
    if (tinygltf::GetNumComponentsInType(uint32_t(a.type)) != components)
        throw Error(where + " does not have " + std::to_string(components) + " components");
    const int size = tinygltf::GetComponentSizeInBytes(uint32_t(a.componentType));
    if (size <= 0 || size == 8) throw Error(where + " has an unknown component type");

    // `count` elements from a view, each checked to lie inside it.
    auto bytes = [&](int viewIndex, size_t offset, size_t count, size_t element, bool strided, size_t& stride) {
        if (viewIndex < 0 || size_t(viewIndex) >= model.bufferViews.size()) throw missing;
        const tinygltf::BufferView& view = model.bufferViews[viewIndex];
        if (view.buffer < 0 || size_t(view.buffer) >= model.buffers.size()) throw missing;
        const auto& data = model.buffers[view.buffer].data;
        stride = strided && view.byteStride ? view.byteStride : element;
        const bool inView = view.byteLength <= data.size() && view.byteOffset <= data.size() - view.byteLength
                         && offset <= view.byteLength && stride >= element
                         && (count == 0 || (element <= view.byteLength - offset
                                            && (count - 1) <= (view.byteLength - offset - element) / stride));
        if (!inView) throw Error(where + " reaches outside its buffer");
        return data.data() + view.byteOffset + offset;
    };
    auto component = [&](const unsigned char* p) -> float {
        auto load = [p](auto value) {
            std::memcpy(&value, p, sizeof value);
            return value;
        };
        auto scaled = [&](float value, float top) { return a.normalized ? std::max(value / top, -1.0f) : value; };
        switch (a.componentType) {
            case TINYGLTF_COMPONENT_TYPE_BYTE: return scaled(load(int8_t{}), 127);
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return scaled(load(uint8_t{}), 255);
            case TINYGLTF_COMPONENT_TYPE_SHORT: return scaled(load(int16_t{}), 32767);
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return scaled(load(uint16_t{}), 65535);
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: return float(load(uint32_t{}));
            case TINYGLTF_COMPONENT_TYPE_FLOAT: return load(float{});
            default: throw Error(where + " has an unknown component type");
        }
    };

    const size_t element = size_t(size) * components;
    // Nothing can hold more elements than the buffers have bytes, but for a sparse accessor of zeros.
    if (a.count > (size_t(1) << 31)) throw Error(where + " has too many elements");
    std::vector<float> out;
    if (a.bufferView >= 0) {
        size_t stride = 0;
        const unsigned char* data = bytes(a.bufferView, a.byteOffset, a.count, element, true, stride);
        out.resize(a.count * components);
        for (size_t i = 0; i < a.count; ++i)
            for (int c = 0; c < components; ++c) out[i * components + c] = component(data + i * stride + c * size);
    } else {
        if (!a.sparse.isSparse) throw missing;
        if (a.count > (size_t(1) << 26)) throw Error(where + " has too many elements");
        out.resize(a.count * components);
    }
    if (a.sparse.isSparse) {
        const auto& sparse = a.sparse;
        const int indexSize = tinygltf::GetComponentSizeInBytes(uint32_t(sparse.indices.componentType));
        if (sparse.count < 0 || size_t(sparse.count) > a.count || (indexSize != 1 && indexSize != 2 && indexSize != 4))
            throw Error(where + " is sparse with a wrong count or index type");
        size_t indexStride = 0, valueStride = 0;
        const unsigned char* indices = bytes(sparse.indices.bufferView, size_t(sparse.indices.byteOffset),
                                             size_t(sparse.count), size_t(indexSize), false, indexStride);
        const unsigned char* values = bytes(sparse.values.bufferView, size_t(sparse.values.byteOffset),
                                            size_t(sparse.count), element, false, valueStride);
        for (size_t i = 0; i < size_t(sparse.count); ++i) {
            uint32_t at = 0;
            std::memcpy(&at, indices + i * indexStride, size_t(indexSize));  // little-endian, as glTF is
            if (at >= a.count) throw Error(where + " has a sparse index out of range");
            for (int c = 0; c < components; ++c)
                out[at * components + c] = component(values + i * valueStride + c * size);
        }
    }
    return out;
}

std::vector<unsigned char> editGltfJson(std::vector<unsigned char> bytes, const std::string& path,
                                        const std::function<bool(nlohmann::json&)>& edit) {
    const bool binary = bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0;
    size_t begin = 0, end = bytes.size();
    if (binary) {
        if (bytes.size() < 20 || word(bytes, 8) != bytes.size() || word(bytes, 12) > bytes.size() - 20)
            throw Error(path + ": truncated or damaged: " + std::to_string(bytes.size()) + " bytes where the header says "
                        + std::to_string(bytes.size() >= 12 ? word(bytes, 8) : 12));
        begin = 20;
        end = begin + word(bytes, 12);
    }
    if (nestsTooDeep(bytes.data() + begin, end - begin)) throw Error(path + ": not a valid glTF file: nested too deep");
    Json document = Json::parse(bytes.begin() + ptrdiff_t(begin), bytes.begin() + ptrdiff_t(end));
    if (!edit(document)) return bytes;
    std::string text = document.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::vector<unsigned char> out(bytes.begin(), bytes.begin() + ptrdiff_t(begin));
    out.insert(out.end(), text.begin(), text.end());
    out.insert(out.end(), bytes.begin() + ptrdiff_t(end), bytes.end());
    if (binary) {
        const auto length = uint32_t(text.size()), total = uint32_t(out.size());
        std::memcpy(&out[8], &total, 4);
        std::memcpy(&out[12], &length, 4);
    }
    return out;
}

Scene readGltf(const std::string& path) {
    Scene scene;
    scene.name = path;
    scene.document = std::make_shared<GltfDocument>();
    Model& model = scene.document->model;
    model = parse(path, scene.document->json);
    decodeMeshopt(model, path);
    expandInstancing(model, path);

    Walker walker(scene, model);
    const int which = model.defaultScene >= 0 ? model.defaultScene : 0;
    if (size_t(which) < model.scenes.size()) {
        for (int node : model.scenes[which].nodes) walker.visit(node, glm::dmat4(1));
    } else {
        std::vector<bool> child(model.nodes.size());
        for (const auto& node : model.nodes)
            for (int c : node.children)
                if (c >= 0 && size_t(c) < child.size()) child[c] = true;
        for (size_t n = 0; n < model.nodes.size(); ++n)
            if (!child[n]) walker.visit(int(n), glm::dmat4(1));
    }
    validate(scene);
    return scene;
}

}  // namespace apertura
