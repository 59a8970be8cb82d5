#include "apertura/runtime/asset/asset.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include "apertura/runtime/asset/bent_normals.h"
#include "apertura/runtime/asset/bounces.h"
#include "apertura/runtime/asset/faces.h"
#include "apertura/runtime/asset/file.h"
#include "apertura/runtime/asset/gltf.h"
#include "apertura/runtime/asset/gltf_writer.h"
#include "apertura/runtime/asset/model_numbers.h"
#include "apertura/runtime/asset/params_stream.h"
#include "apertura/runtime/asset/primitive.h"
#include "apertura/runtime/asset/texels.h"
#include "apertura/sh/packing.h"

namespace apertura {
namespace {

const char* const kAttribute = "_VISIBILITY";
// Limit of JSON values that instances may repeat: a base, and more per byte of the file.
constexpr double kFewValues = 0x1p20, kValuesAByte = 32;
// Recipes that make the four numbers and store nothing beside them; and `horizon`, whose heights files of 0.1 hold about other tangents
// than horizon-16 reads: of such a file the four numbers are read.
const char* const kFromFour[] = {"sh", "rays", "sh-fit", "transfer", "horizon"};

template <typename T>
Bytes bytesOf(const std::vector<T>& values) {
    Bytes out(values.size() * sizeof(T));
    if (!values.empty()) std::memcpy(out.data(), values.data(), out.size());
    return out;
}

size_t addVectors(GltfWriter& writer, const std::vector<glm::vec3>& values, Json members = Json::object()) {
    members.update({{"componentType", kFloat}, {"type", "VEC3"}, {"count", values.size()}});
    return writer.addAccessor(std::move(members), bytesOf(values), kArrayBuffer);
}

size_t addIndices(GltfWriter& writer, const Surface& surface) {
    std::vector<uint32_t> wide;
    for (const auto& t : surface.triangles) wide.insert(wide.end(), t.begin(), t.end());
    const Json members{{"type", "SCALAR"}, {"count", wide.size()}};
    auto add = [&](GltfComponent type, Bytes bytes) {
        Json all = members;
        all["componentType"] = type;
        return writer.addAccessor(std::move(all), std::move(bytes), kElementArrayBuffer);
    };
    if (surface.positions.size() >= 65535) return add(kUnsignedInt, bytesOf(wide));
    return add(kUnsignedShort, bytesOf(std::vector<uint16_t>(wide.begin(), wide.end())));
}

Json numbers(const glm::vec3& v) { return Json::array({v.x, v.y, v.z}); }

// Adds a scene that has no document and sets the instances' `node` and `primitive`.
void addScene(GltfWriter& writer, Scene& scene) {
    Json& json = writer.json();
    json["scene"] = 0;
    json["scenes"] = Json::array({{{"nodes", Json::array()}}});
    for (const Surface& surface : scene.surfaces) {
        Box box;
        for (const glm::vec3& p : surface.positions) box = {glm::min(box.low, p), glm::max(box.high, p)};
        Json primitive;
        primitive["attributes"]["POSITION"] = addVectors(writer, surface.positions,
                                                         {{"min", numbers(box.low)}, {"max", numbers(box.high)}});
        primitive["attributes"]["NORMAL"] = addVectors(writer, surface.normals);
        if (!surface.coordinates.empty())
            primitive["attributes"]["TEXCOORD_0"] = writer.addAccessor(
                {{"componentType", kFloat}, {"type", "VEC2"}, {"count", surface.coordinates.size()}}, bytesOf(surface.coordinates),
                kArrayBuffer);
        primitive["indices"] = addIndices(writer, surface);
        primitive["mode"] = kTriangles;
        json["meshes"].push_back({{"primitives", Json::array({primitive})}});
    }
    for (Instance& instance : scene.instances) {
        Json node{{"mesh", instance.surface}};
        if (instance.toWorld != glm::mat4(1))
            for (int i = 0; i < 16; ++i) node["matrix"].push_back(instance.toWorld[i / 4][i % 4]);
        instance.node = int(json["nodes"].size());
        instance.primitive = 0;
        json["scenes"][0]["nodes"].push_back(instance.node);
        json["nodes"].push_back(std::move(node));
    }
    if (!scene.cameras.empty()) addCamera(json, scene.cameras.front());
}

Json describe(const BakeInfo& info) {
    Json out{{"version", info.version},
             {"scene", info.scene},
             {"model", info.model},
             {"tolerance", info.tolerance},
             {"rays", info.rays},
             {"bits", info.bits},
             {"seed", info.seed},
             {"maxDistance", info.maxDistance},
             {"rayOffset", info.rayOffset},
             {"hemisphere", info.hemisphere},
             {"at", info.at}};
    if (info.azimuths > 0) out["azimuths"] = info.azimuths, out["meshError"] = info.meshError;
    if (info.unmetArea > 0) out["unmetArea"] = info.unmetArea;
    if (!info.price.empty()) out["price"] = info.price;
    if (!info.alone.empty()) out["alone"] = info.alone;
    if (!info.bounce.empty()) out["bounce"] = info.bounce;
    return out;
}

const Json& describedIn(const Json& json) { return listOf(listOf(json["asset"], "extras"), "apertura"); }

// Removes what an earlier bake added.
void removeBaked(GltfWriter& writer) {
    Json& json = writer.json();
    std::set<size_t> accessors, views;
    if (json.contains("meshes"))
        for (Json& mesh : json["meshes"]) {
            if (!mesh.contains("primitives")) continue;
            for (Json& primitive : mesh["primitives"])
                if (const auto found = primitive["attributes"].find(kAttribute); found != primitive["attributes"].end()) {
                    accessors.insert(found->get<size_t>());
                    primitive["attributes"].erase(found);
                }
        }
    if (const Json& baked = describedIn(json); baked.is_object()) {
        removeBentNormals(json, accessors, views);
        views.merge(removeTexels(json));
        accessors.merge(removeBounces(json));
    }
    ReleasedNumbers numbers = removeNumbers(json);
    accessors.merge(numbers.accessors);
    views.merge(numbers.views);
    accessors.merge(removeFaces(json));
    writer.release(accessors, views);
}

// Gives the primitive the surface's vertices and normals where these differ from the file's. Adds the accessors that are
// no longer used to `replaced`.
void replaceGeometry(GltfWriter& writer, const GltfDocument& document, const Surface& surface, Json& primitive,
                     std::set<size_t>& replaced) {
    if (!surface.splitFrom.empty()) {
        // The file's tangents had no meaning without normals; with the new normals readers would use them.
        if (primitive["attributes"].contains("TANGENT")) {
            replaced.insert(primitive["attributes"]["TANGENT"].get<size_t>());
            primitive["attributes"].erase("TANGENT");
        }
        if (primitive.contains("extensions")) primitive["extensions"].erase("CESIUM_primitive_outline");  // indexes the old vertices
        auto gather = [&](Json& attributes) {
            for (Json& index : attributes) {
                GatheredAccessor gathered = gatherAccessor(document, index.get<size_t>(), surface.splitFrom);
                replaced.insert(index.get<size_t>());
                index = writer.addAccessor(std::move(gathered.members), std::move(gathered.bytes), kArrayBuffer, gathered.stride);
            }
        };
        gather(primitive["attributes"]);
        if (primitive.contains("targets"))
            for (Json& target : primitive["targets"]) gather(target);
        if (primitive.contains("indices")) replaced.insert(primitive["indices"].get<size_t>());
        primitive["indices"] = addIndices(writer, surface);
        primitive["mode"] = kTriangles;
    } else if (primitive["attributes"].contains("NORMAL")) {
        replaced.insert(primitive["attributes"]["NORMAL"].get<size_t>());
    }
    primitive["attributes"]["NORMAL"] = addVectors(writer, surface.normals);
}

template <typename Packed>
std::vector<Packed> packAll(const std::vector<Visibility>& points, const glm::mat3& toWorld, Packed (*pack)(const Visibility&)) {
    std::vector<Packed> out;
    out.reserve(points.size());
    const glm::mat3 toLocal = glm::transpose(toWorld);
    for (const Visibility& v : points) out.push_back(pack({toLocal * v.direction, v.area}));
    return out;
}

size_t addVisibility(GltfWriter& writer, const std::vector<Visibility>& points, const glm::mat3& rotation, int bits) {
    return writer.addAccessor(
        {{"componentType", bits == 16 ? kShort : kByte}, {"normalized", true}, {"type", "VEC4"}, {"count", points.size()}},
        bits == 16 ? bytesOf(packAll<Packed16>(points, rotation, pack16)) : bytesOf(packAll<Packed8>(points, rotation, pack8)),
        kArrayBuffer);
}

// Gives each node that the scene draws a mesh of its own, a copy of the first one's JSON, since nodes that share a mesh see
// different skies and nodes that are not drawn have none. Accessors stay shared.
void separateMeshes(Json& json, const Scene& scene, const GltfDocument& document) {
    std::set<size_t> drawn;
    for (const Instance& instance : scene.instances) drawn.insert(size_t(instance.node));
    std::set<size_t> taken;  // meshes that have their node
    Json& nodes = json["nodes"];
    for (size_t n = 0; n < nodes.size(); ++n)
        if (nodes[n].contains("mesh") && !drawn.contains(n)) taken.insert(nodes[n]["mesh"].get<size_t>());
    const Json original = json["meshes"];
    std::map<size_t, double> sizes;
    Budget copies(document, "the copies of meshes that its instances need", kFewValues, kValuesAByte);
    for (const size_t n : drawn) {
        const size_t mesh = nodes[n]["mesh"].get<size_t>();
        if (taken.insert(mesh).second) continue;
        const auto [size, fresh] = sizes.try_emplace(mesh, 0);
        if (fresh) size->second = valuesIn(original[mesh]);
        copies.spend(size->second);
        nodes[n]["mesh"] = json["meshes"].size();
        json["meshes"].push_back(original[mesh]);
    }
}

BakeInfo readInfo(const Json& said, const std::string& name) {
    BakeInfo info;
    auto number = [&](const char* key, double fallback) {
        return said.contains(key) && said[key].is_number() ? said[key].get<double>() : fallback;
    };
    auto text = [&](const char* key) { return said.contains(key) && said[key].is_string() ? said[key].get<std::string>() : std::string(); };
    info.version = text("version");
    info.scene = text("scene");
    if (!text("model").empty()) info.model = text("model");
    if (!storedModel(info) && std::find(std::begin(kFromFour), std::end(kFromFour), info.model) == std::end(kFromFour))
        throw Error(name + ": was baked for a model that is not known here");
    info.rays = int(std::clamp(number("rays", 0), 0.0, 1e9));
    info.seed = uint32_t(std::clamp(number("seed", 0), 0.0, 4294967295.0));
    info.azimuths = int(std::clamp(number("azimuths", 0), 0.0, 1e9));
    info.meshError = number("meshError", 0);
    info.maxDistance = number("maxDistance", 0);
    info.rayOffset = number("rayOffset", 0);
    info.hemisphere = text("hemisphere");
    info.tolerance = number("tolerance", 0);
    info.price = text("price");
    info.at = text("at") == "faces" || text("at") == "texels" ? text("at") : "vertices";
    info.unmetArea = number("unmetArea", 0);
    info.alone = text("alone");
    info.bounce = text("bounce");
    const double packing = number("packing", said.contains("packing") ? NAN : 1);
    if (storedModel(info) && packing != 1 && packing != kPacking)
        throw Error(name + ": its model's numbers are packed in a way that is not known here");
    info.packing = storedModel(info) ? int(packing) : kPacking;
    return info;
}

}  // namespace

void requireStorable(const BakeInfo& info, const std::string& name) {
    try {
        describe(info).dump();
    } catch (const Json::exception&) {
        throw Error(name + ": its name is not UTF-8, which is all that an asset can hold");
    }
}

void writeAsset(const std::string& path, const Scene& given, const BakedVisibility& visibility, const BakeInfo& info) {
    requireStorable(info, given.name);
    PendingFile file(path);
    Scene scene = given;
    GltfDocument made;
    made.json = {{"asset", {{"version", "2.0"}}}};
    const GltfDocument& document = scene.document ? *scene.document : made;
    GltfWriter writer(document);
    Json& json = writer.json();
    if (scene.document)
        removeBaked(writer);
    else
        addScene(writer, scene);
    separateMeshes(json, scene, document);

    const Model* stored = storedModel(info);
    std::map<int, Json> geometry;  // by surface: its primitive, if that differs from the file's
    std::set<size_t> replaced;     // accessors
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        Json& primitive = json["meshes"][meshOf(json, instance)]["primitives"][size_t(instance.primitive)];
        const Surface& surface = scene.surfaces[size_t(instance.surface)];
        if (scene.document && surface.normalsMade) {
            const auto [own, fresh] = geometry.try_emplace(instance.surface);
            if (fresh) {
                own->second = primitive;
                replaceGeometry(writer, document, surface, own->second, replaced);
            }
            primitive = own->second;
        }
        const glm::mat3 rotation = rotationPart(instance.toWorld);
        primitive["attributes"][kAttribute] = addVisibility(writer, visibility[i].visibility, rotation, info.bits);
        if (!visibility[i].bounces.empty()) addBounces(writer, primitive, visibility[i].bounces, rotation);
        if (stored) addNumbers(writer, primitive, *stored, visibility[i], rotation, info.bits);
    }
    Json& asset = json["asset"];
    Json description = describe(info);
    const Json& before = describedIn(json);
    for (const char* key : {"mergedBuffers", "inputGenerator"})
        if (before.is_object() && before.contains(key)) description[key] = before[key];
    if (scene.document && asset.contains("generator") && !asset["generator"].dump().starts_with("\"Apertura "))
        description["inputGenerator"] = asset["generator"];
    asset["generator"] = "Apertura " + info.version;
    if (asset.contains("extras") && !asset["extras"].is_object()) asset["extras"] = {{"input", asset["extras"]}};
    if (Json choices = addChoices(writer, scene, visibility, stored, info.bits); !choices.is_null())
        description["choices"] = std::move(choices);
    if (Json faces = addFaces(writer, scene, visibility, stored, info.bits); !faces.is_null()) description["faces"] = std::move(faces);
    addBouncesOnFaces(writer, scene, visibility);
    if (Json texels = addTexels(writer, scene, visibility, info.bits); !texels.is_null()) description["texels"] = std::move(texels);
    if (Json bent = addBentNormals(writer, scene, visibility, info.bits); !bent.is_null()) description["bentNormals"] = std::move(bent);
    if (stored) description["packing"] = kPacking;
    asset["extras"]["apertura"] = description;
    writer.release(replaced);
    writer.write(path, file.name());
    file.commit();
}

bool hasVisibility(const Scene& scene) {
    if (!scene.document) return false;
    for (const Json& mesh : listOf(scene.document->json, "meshes"))
        for (const Json& primitive : listOf(mesh, "primitives"))
            if (primitive["attributes"].contains(kAttribute)) return true;
    return false;
}

bool lostVisibility(const Scene& scene) { return scene.document && describedIn(scene.document->json).is_object() && !hasVisibility(scene); }

Asset toAsset(Scene scene) {
    Asset asset;
    if (!hasVisibility(scene))
        throw Error(scene.name + ": holds no baked visibility" + (lostVisibility(scene) ? " any more" : "")
                    + "; make it with `apertura bake`");
    const GltfDocument& document = *scene.document;
    const Json& described = describedIn(document.json);
    if (described.is_object()) {
        asset.info = readInfo(described, scene.name);
        asset.info.bentNormals = countBentNormals(document.json, described);
        if (asset.info.bentNormals > 0)
            scene.notes.push_back("its images are bent normals and occlusion for engines: what its vertices store is drawn and measured");
    }
    std::vector<std::vector<glm::vec4>> atVertices;  // of each instance, as stored
    for (const Instance& instance : scene.instances) {
        const Json& attributes = primitiveOf(document, instance)["attributes"];
        const std::string where = scene.name + ": mesh " + std::to_string(meshOf(document.json, instance));
        if (!attributes.contains(kAttribute)) throw Error(where + " holds no baked visibility");
        const size_t index = attributes[kAttribute].get<size_t>();
        const Json& accessor = document.json["accessors"][index];
        const bool wide = accessor["componentType"] == kShort;
        if (!accessor.value("normalized", false) || (!wide && accessor["componentType"] != kByte))
            throw Error(scene.name + ": _VISIBILITY is not of normalised bytes or shorts");
        const std::vector<float> values = readAccessor(document, index, 4);
        asset.info.bits = wide ? 16 : 8;
        const glm::mat3 rotation = rotationPart(instance.toWorld);
        const Surface& surface = scene.surfaces[size_t(instance.surface)];
        std::vector<glm::vec4>& stores = atVertices.emplace_back();
        std::vector<Visibility> points;
        for (size_t i = 0; i + 3 < values.size(); i += 4) {
            stores.emplace_back(values[i], values[i + 1], values[i + 2], values[i + 3]);
            points.push_back(unpack(stores.back()));
            points.back().direction = rotation * points.back().direction;
        }
        asset.seen.push_back({std::move(points), {}, {}, {}});
        // Where normals were removed from the baked file, reading it split vertices: all parts of a vertex see the same.
        if (!pick(asset.seen.back().visibility, surface.splitFrom) || !pick(stores, surface.splitFrom))
            throw Error(where + ": has less visibility than vertices");
    }
    asset.scene = std::move(scene);
    readFaces(asset, described, atVertices);
    readNumbers(asset, described, atVertices);
    readTexels(asset, described);
    readBounces(asset);
    return asset;
}

Asset loadAsset(const std::string& path) { return toAsset(readGltf(path)); }

const Model* storedModel(const BakeInfo& info) {
    const Model* model = findModel(info.model);
    return model && model->isStored() && model->name == info.model ? model : nullptr;  // not by an alias: see kFromFour
}

bool hasSamplesOnFaces(const Asset& asset) {
    return std::any_of(asset.seen.begin(), asset.seen.end(), [](const SeenByInstance& seen) { return !seen.faces.visibility.empty(); });
}

bool hasTexels(const Asset& asset) {
    return std::any_of(asset.seen.begin(), asset.seen.end(), [](const SeenByInstance& seen) { return !seen.texels.visibility.empty(); });
}

double bytesAPoint(const Asset& asset) {
    size_t points = 0;
    for (const SeenByInstance& seen : asset.seen) points += seen.visibility.size() + seen.faces.visibility.size();
    const Model* stored = storedModel(asset.info);
    double bytes = double(points) * asset.info.bits / 2;
    for (const SeenByInstance& seen : asset.seen) bytes += double(bytesOfNumbers(stored, seen.allParams, asset.info.bits, true));
    for (const SeenByInstance& seen : asset.seen) bytes += double(bytesOfNumbers(stored, seen.faces.allParams, asset.info.bits, false));
    return bytes / std::max(double(points), 1.0);
}

size_t visibilityBytes(const Asset& asset) {
    const Model* stored = storedModel(asset.info);
    size_t out = bytesOfFaces(asset.scene, asset.seen, stored, asset.info.bits);
    for (const SeenByInstance& seen : asset.seen)
        out += seen.visibility.size() * size_t(asset.info.bits / 2) + seen.texels.visibility.size() * size_t(seen.texels.bits / 2)
             + bytesOfNumbers(stored, seen.allParams, asset.info.bits, true);
    return out;
}

}  // namespace apertura
