#include "runtime/asset.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "runtime/file.h"
#include "runtime/form_stream.h"
#include "runtime/gltf.h"
#include "sh/packing.h"

namespace apertura {
namespace {

using Document = tinygltf::Model;
using tinygltf::Value;
const char* const kAttribute = "_VISIBILITY";
// Ways to make the four numbers, with nothing stored beside them.
const char* const kFromFour[] = {"sh", "rays", "sh-fit", "transfer"};

// Appends `bytes` as a view of buffer 0, aligned to 4; returns the view's index.
int addView(Document& model, const void* bytes, size_t size, int target) {
    auto& data = model.buffers[0].data;
    data.resize((data.size() + 3) / 4 * 4);
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = data.size();
    view.byteLength = size;
    view.target = target;
    const auto* first = static_cast<const unsigned char*>(bytes);
    data.insert(data.end(), first, first + size);
    model.bufferViews.push_back(view);
    return int(model.bufferViews.size()) - 1;
}

template <typename T>
int addAccessor(Document& model, const std::vector<T>& values, int componentType, int type, int target,
                bool normalized = false) {
    tinygltf::Accessor accessor;
    accessor.bufferView = addView(model, values.data(), values.size() * sizeof(T), target);
    accessor.componentType = componentType;
    accessor.type = type;
    accessor.count = values.size();
    accessor.normalized = normalized;
    model.accessors.push_back(accessor);
    return int(model.accessors.size()) - 1;
}

int addVectors(Document& model, const std::vector<glm::vec3>& values) {
    return addAccessor(model, values, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_VEC3, TINYGLTF_TARGET_ARRAY_BUFFER);
}

int addIndices(Document& model, const Surface& surface) {
    if (surface.positions.size() >= 65535) {
        std::vector<uint32_t> wide;
        for (const auto& t : surface.triangles) wide.insert(wide.end(), t.begin(), t.end());
        return addAccessor(model, wide, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR,
                           TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    }
    std::vector<uint16_t> narrow;
    for (const auto& t : surface.triangles) narrow.insert(narrow.end(), t.begin(), t.end());
    return addAccessor(model, narrow, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TYPE_SCALAR,
                       TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
}

void addCamera(Document& model, const Camera& view) {
    tinygltf::Camera camera;
    camera.type = "perspective";
    camera.perspective.yfov = view.verticalFov;
    camera.perspective.znear = 0.01;
    model.cameras.push_back(camera);
    const glm::dvec3 back = glm::normalize(glm::dvec3(view.eye - view.target));
    const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), back)), up = glm::cross(back, right);
    tinygltf::Node node;
    node.name = "camera";
    node.camera = 0;
    node.matrix = {right.x, right.y, right.z, 0, up.x, up.y, up.z, 0, back.x, back.y, back.z, 0,
                   view.eye.x, view.eye.y, view.eye.z, 1};
    model.scenes[0].nodes.push_back(int(model.nodes.size()));
    model.nodes.push_back(node);
}

// A document for a scene that has none; sets the instances' places in it.
Document makeDocument(Scene& scene) {
    Document model;
    model.asset.version = "2.0";
    model.buffers.emplace_back();
    model.scenes.emplace_back();
    model.defaultScene = 0;
    for (const Surface& surface : scene.surfaces) {
        tinygltf::Primitive primitive;
        primitive.mode = TINYGLTF_MODE_TRIANGLES;
        const int position = addVectors(model, surface.positions);
        Box box;
        for (const glm::vec3& p : surface.positions) box = {glm::min(box.low, p), glm::max(box.high, p)};
        model.accessors[position].minValues = {box.low.x, box.low.y, box.low.z};
        model.accessors[position].maxValues = {box.high.x, box.high.y, box.high.z};
        primitive.attributes["POSITION"] = position;
        primitive.attributes["NORMAL"] = addVectors(model, surface.normals);
        primitive.indices = addIndices(model, surface);
        tinygltf::Mesh mesh;
        mesh.primitives.push_back(primitive);
        model.meshes.push_back(mesh);
    }
    for (Instance& instance : scene.instances) {
        tinygltf::Node node;
        node.mesh = instance.surface;
        if (instance.toWorld != glm::mat4(1))
            for (int i = 0; i < 16; ++i) node.matrix.push_back(instance.toWorld[i / 4][i % 4]);
        instance.node = int(model.nodes.size());
        instance.primitive = 0;
        model.scenes[0].nodes.push_back(instance.node);
        model.nodes.push_back(node);
    }
    if (scene.camera) addCamera(model, *scene.camera);
    return model;
}

// By the first bytes of the file, as each format's specification has them.
std::string mimeTypeOf(const std::vector<unsigned char>& bytes) {
    const std::string head(bytes.begin(), bytes.begin() + ptrdiff_t(std::min<size_t>(bytes.size(), 12)));
    if (head.starts_with("\xFF\xD8")) return "image/jpeg";
    if (head.starts_with("\xABKTX 20")) return "image/ktx2";
    if (head.starts_with("RIFF") && head.substr(8) == "WEBP") return "image/webp";
    return "image/png";
}

// A .glb holds one buffer: all of them, one behind the other, images included.
void mergeBuffers(Document& model) {
    std::vector<unsigned char> all;
    std::vector<size_t> start;
    for (const auto& buffer : model.buffers) {
        all.resize((all.size() + 15) / 16 * 16);
        start.push_back(all.size());
        all.insert(all.end(), buffer.data.begin(), buffer.data.end());
    }
    for (auto& view : model.bufferViews)
        if (view.buffer >= 0) {
            if (size_t(view.buffer) >= start.size()) throw Error("a buffer view's buffer does not exist");
            view.byteOffset += start[view.buffer];
            view.buffer = 0;
        }
    tinygltf::Buffer merged;
    if (!model.buffers.empty()) merged = model.buffers[0];
    merged.uri.clear();
    merged.data = std::move(all);
    model.buffers.assign(1, merged);
    for (auto& image : model.images) {
        if (image.bufferView >= 0 || image.image.empty()) continue;
        if (image.mimeType.empty()) image.mimeType = mimeTypeOf(image.image);
        image.bufferView = addView(model, image.image.data(), image.image.size(), 0);
        image.uri.clear();
    }
}

// tinygltf writes the far plane of an infinite projection, which glTF leaves out, as 0. True if it did.
bool dropEmptyFarPlanes(nlohmann::json& document) {
    bool changed = false;
    if (!document.contains("cameras")) return false;
    for (auto& camera : document["cameras"])
        if (camera.contains("perspective") && camera["perspective"].value("zfar", 1.0) == 0) {
            camera["perspective"].erase("zfar");
            changed = true;
        }
    return changed;
}

using Json = nlohmann::json;

// Copies the members of `from` into `to`, but for those named.
void copyMembers(Json& to, const Json& from, const std::set<std::string>& except) {
    for (const auto& [key, value] : from.items())
        if (!except.contains(key)) to[key] = value;
}

// Gives back what tinygltf does not carry through: large integers, null and empty values, unknown members.
// It keeps the order of every array, so that what the file had stands at its old index; what baking itself
// changes (buffers, images, attributes, the meshes and children of nodes) stays as written.
void restoreContent(Json& written, const Json& original) {
    copyMembers(written, original, {"accessors", "asset", "bufferViews", "buffers", "extensionsRequired", "extensionsUsed",
                                    "images", "meshes", "nodes", "scene"});
    auto each = [&](const char* key, auto&& restore) {
        if (!original.contains(key) || !written.contains(key)) return;
        for (size_t i = 0; i < original[key].size() && i < written[key].size(); ++i)
            restore(written[key][i], original[key][i]);
    };
    each("accessors", [](Json& to, const Json& from) { copyMembers(to, from, {}); });
    each("images", [](Json& to, const Json& from) { copyMembers(to, from, {"uri", "bufferView", "mimeType"}); });
    each("nodes", [](Json& to, const Json& from) { copyMembers(to, from, {"mesh", "children", "extensions"}); });
    each("meshes", [](Json& to, const Json& from) {
        copyMembers(to, from, {"primitives"});
        if (!from.contains("primitives")) return;
        for (size_t p = 0; p < from["primitives"].size() && p < to["primitives"].size(); ++p)
            copyMembers(to["primitives"][p], from["primitives"][p], {"attributes"});
    });
    if (original.contains("asset")) {
        Json asset = original["asset"];
        asset["generator"] = written["asset"]["generator"];
        if (!asset.contains("extras") || !asset["extras"].is_object()) asset["extras"] = Json::object();
        asset["extras"]["apertura"] = written["asset"]["extras"]["apertura"];
        written["asset"] = asset;
    }
}

Value::Object describe(const BakeInfo& info) {
    return Value::Object{{"version", Value(info.version)},
                               {"scene", Value(info.scene)},
                               {"model", Value(info.model)},
                               {"tolerance", Value(info.tolerance)},
                               {"rays", Value(info.rays)},
                               {"bits", Value(info.bits)},
                               {"seed", Value(double(info.seed))},
                               {"maxDistance", Value(info.maxDistance)},
                               {"rayOffset", Value(info.rayOffset)},
                               {"hemisphere", Value(info.hemisphere)}};
}

// The buffer view of each primitive's forms, by mesh and primitive.
std::map<std::pair<int, int>, int> findStreams(const Document& model) {
    std::map<std::pair<int, int>, int> out;
    const Value& forms = model.asset.extras.Get("apertura").Get("forms");
    if (!forms.IsArray()) return out;
    for (size_t i = 0; i < forms.ArrayLen(); ++i) {
        const Value& entry = forms.Get(int(i));
        auto index = [&](const char* key) { 
            const double x = entry.IsObject() && entry.Get(key).IsNumber() ? entry.Get(key).GetNumberAsDouble() : -1;
            return x >= 0 && x < 1e9 ? int(x) : -1;
        };
        out[{index("mesh"), index("primitive")}] = index("bufferView");
    }
    return out;
}

std::span<const unsigned char> viewBytes(const Document& model, int index) {
    if (index < 0 || size_t(index) >= model.bufferViews.size()) throw Error("the model's buffer view does not exist");
    const tinygltf::BufferView& view = model.bufferViews[size_t(index)];
    if (view.buffer < 0 || size_t(view.buffer) >= model.buffers.size()) throw Error("the model's buffer does not exist");
    const auto& data = model.buffers[size_t(view.buffer)].data;
    if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset) throw Error("the model's buffer view ends outside its buffer");
    return {data.data() + view.byteOffset, view.byteLength};
}

template <typename Packed>
std::vector<Packed> packAll(const std::vector<Visibility>& points, const glm::mat3& toWorld, Packed (*pack)(const Visibility&)) {
    std::vector<Packed> out;
    out.reserve(points.size());
    const glm::mat3 toLocal = glm::transpose(toWorld);
    for (const Visibility& v : points) out.push_back(pack({toLocal * v.direction, v.area}));
    return out;
}

}  // namespace

void writeAsset(const std::string& path, const Scene& given, const BakedVisibility& visibility, const BakeInfo& info) {
    PendingFile file(path);
    Scene scene = given;
    Document model = scene.document ? scene.document->model : makeDocument(scene);
    try {
        mergeBuffers(model);
    } catch (const Error& e) {
        throw Error(scene.name + ": " + e.what());
    }
    model.asset.generator = "Apertura " + info.version;
    const Model* stored = storedModel(info);
    Value::Array streams;

    // Of several nodes that share a mesh, all but the first get a copy of its primitives' lists.
    std::map<int, int> owner;        // mesh -> first node
    std::map<int, int> madeNormals;  // surface -> accessor
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        tinygltf::Node& node = model.nodes[instance.node];
        if (const auto [first, fresh] = owner.try_emplace(node.mesh, instance.node);
            !fresh && first->second != instance.node) {
            const tinygltf::Mesh copy = model.meshes[node.mesh];
            node.mesh = int(model.meshes.size());
            model.meshes.push_back(copy);
            owner[node.mesh] = instance.node;
        }
        tinygltf::Primitive& primitive = model.meshes[node.mesh].primitives[instance.primitive];
        const Surface& surface = scene.surfaces[instance.surface];
        const glm::mat3 rotation = rotationPart(instance.toWorld);
        primitive.attributes[kAttribute] =
            info.bits == 16
                ? addAccessor(model, packAll<Packed16>(visibility[i].visibility, rotation, pack16), TINYGLTF_COMPONENT_TYPE_SHORT,
                              TINYGLTF_TYPE_VEC4, TINYGLTF_TARGET_ARRAY_BUFFER, true)
                : addAccessor(model, packAll<Packed8>(visibility[i].visibility, rotation, pack8), TINYGLTF_COMPONENT_TYPE_BYTE,
                              TINYGLTF_TYPE_VEC4, TINYGLTF_TARGET_ARRAY_BUFFER, true);
        if (stored) {
            const std::vector<std::byte> bytes = packForms(*stored, visibility[i].forms, glm::transpose(rotation), info.bits);
            streams.push_back(Value(Value::Object{{"mesh", Value(node.mesh)},
                                                  {"primitive", Value(instance.primitive)},
                                                  {"bufferView", Value(addView(model, bytes.data(), bytes.size(), 0))}}));
        }
        if (surface.normalsMade) {
            const auto [made, fresh] = madeNormals.try_emplace(instance.surface, -1);
            if (fresh) made->second = addVectors(model, surface.normals);
            primitive.attributes["NORMAL"] = made->second;
        }
    }
    Value::Object extras, description = describe(info);
    if (stored) description["forms"] = Value(streams);
    if (model.asset.extras.IsObject()) extras = model.asset.extras.Get<Value::Object>();
    extras["apertura"] = Value(description);
    model.asset.extras = Value(extras);
    if (model.buffers[0].data.size() > std::numeric_limits<uint32_t>::max() - (1u << 24))
        throw Error(path + ": the asset would be larger than the 4 GiB of a .glb");
    std::ostringstream stream;
    if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, stream, false, true))
        throw Error(path + ": cannot be written as glTF");
    const std::string text = std::move(stream).str();
    const std::vector<unsigned char> bytes = editGltfJson({text.begin(), text.end()}, path, [&](Json& written) {
        if (scene.document) restoreContent(written, Json::parse(scene.document->json));
        return dropEmptyFarPlanes(written) || scene.document;
    });
    std::ofstream out(file.name(), std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    out.close();
    if (!out) throw Error(path + ": cannot be written: " + std::strerror(errno));
    file.commit();
}

bool hasVisibility(const Scene& scene) {
    if (!scene.document) return false;
    for (const auto& mesh : scene.document->model.meshes)
        for (const auto& primitive : mesh.primitives)
            if (primitive.attributes.contains(kAttribute)) return true;
    return false;
}

Asset toAsset(Scene scene) {
    Asset asset;
    if (!hasVisibility(scene)) throw Error(scene.name + ": holds no baked visibility; make it with `apertura bake`");
    const Document& model = scene.document->model;
    if (model.asset.extras.IsObject() && model.asset.extras.Has("apertura")) {
        const Value& said = model.asset.extras.Get("apertura");
        auto number = [&](const char* key, double fallback) {
            return said.Has(key) && said.Get(key).IsNumber() ? said.Get(key).GetNumberAsDouble() : fallback;
        };
        auto text = [&](const char* key) {
            return said.Has(key) && said.Get(key).IsString() ? said.Get(key).Get<std::string>() : std::string();
        };
        asset.info.version = text("version");
        asset.info.scene = text("scene");
        if (!text("model").empty()) asset.info.model = text("model");
        if (!storedModel(asset.info) && std::find(std::begin(kFromFour), std::end(kFromFour), asset.info.model) == std::end(kFromFour))
            throw Error(scene.name + ": was baked for a model that is not known here");
        asset.info.rays = int(std::clamp(number("rays", 0), 0.0, 1e9));
        asset.info.seed = uint32_t(std::clamp(number("seed", 0), 0.0, 4294967295.0));
        asset.info.maxDistance = number("maxDistance", 0);
        asset.info.rayOffset = number("rayOffset", 0);
        asset.info.hemisphere = text("hemisphere");
        asset.info.tolerance = number("tolerance", 0);
    }
    const Model* stored = storedModel(asset.info);
    const std::map<std::pair<int, int>, int> streams = stored ? findStreams(model) : std::map<std::pair<int, int>, int>();
    for (const Instance& instance : scene.instances) {
        const int mesh = model.nodes[instance.node].mesh;
        const auto& attributes = model.meshes[mesh].primitives[instance.primitive].attributes;
        const auto found = attributes.find(kAttribute);
        if (found == attributes.end())
            throw Error(scene.name + ": mesh " + std::to_string(mesh) + " holds no baked visibility");
        const std::vector<float> values = readAccessor(model, found->second, 4, scene.name);
        const tinygltf::Accessor& accessor = model.accessors[found->second];
        const bool wide = accessor.componentType == TINYGLTF_COMPONENT_TYPE_SHORT;
        if (!accessor.normalized || (!wide && accessor.componentType != TINYGLTF_COMPONENT_TYPE_BYTE))
            throw Error(scene.name + ": _VISIBILITY is not of normalised bytes or shorts");
        asset.info.bits = wide ? 16 : 8;
        const glm::mat3 rotation = rotationPart(instance.toWorld);
        std::vector<Visibility> points(values.size() / 4);
        for (size_t i = 0; i < points.size(); ++i) {
            points[i] = unpack(glm::vec4(values[4 * i], values[4 * i + 1], values[4 * i + 2], values[4 * i + 3]));
            points[i].direction = rotation * points[i].direction;
        }
        asset.seen.push_back({std::move(points), {}});
        if (!stored) continue;
        const auto stream = streams.find({mesh, instance.primitive});
        if (stream == streams.end()) throw Error(scene.name + ": mesh " + std::to_string(mesh) + " holds no numbers of the model " + asset.info.model);
        try {
            SeenByInstance& seen = asset.seen.back();
            seen.forms = unpackForms(*stored, viewBytes(model, stream->second), seen.visibility.size(), rotation, asset.info.bits);
        } catch (const Error& e) {
            throw Error(scene.name + ": mesh " + std::to_string(mesh) + ": " + e.what());
        }
    }
    asset.scene = std::move(scene);
    return asset;
}

Asset readAsset(const std::string& path) { return toAsset(readGltf(path)); }

const Model* storedModel(const BakeInfo& info) {
    const Model* model = findModel(info.model);
    return model && (model->storedFields > 0 || model->id == MODEL_AUTO) ? model : nullptr;
}

bool mayMix(const Model& model, bool stored) { return model.mixes && !(stored && model.fromVisibility); }

double bytesAPoint(const Asset& asset) {
    const Model* stored = storedModel(asset.info);
    double numbers = 0, points = 0;
    for (const SeenByInstance& seen : asset.seen) {
        points += double(seen.visibility.size());
        if (!stored) continue;
        for (const Form& form : seen.forms)
            numbers += storedNumbers(models()[size_t(chosenModel(stored->id, form))]);
    }
    const double choice = stored && stored->id == MODEL_AUTO ? 1 : 0;
    return asset.info.bits / 2.0 + choice + numbers / std::max(points, 1.0) * asset.info.bits / 8;
}

}  // namespace apertura
