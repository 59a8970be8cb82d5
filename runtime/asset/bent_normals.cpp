#include "runtime/asset/bent_normals.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "runtime/asset/texels.h"

namespace apertura {
namespace {

const char* const kEntry = "bentNormals";  // of asset.extras.apertura
const char *const kBentName = "bent normal", *const kOcclusionName = "occlusion";

// Of numbers 0..1.
uint16_t code(float number, int bits) { return uint16_t(std::lround(std::clamp(number, 0.0f, 1.0f) * float((1 << bits) - 1))); }

size_t addTexture(GltfWriter& writer, const PngImage& image, const char* name, size_t sampler) {
    Json& json = writer.json();
    const size_t view = writer.addView(encodePng(image));
    json["images"].push_back({{"name", name}, {"mimeType", "image/png"}, {"bufferView", view}});
    json["textures"].push_back({{"name", name}, {"sampler", sampler}, {"source", json["images"].size() - 1}});
    return json["textures"].size() - 1;
}

// The primitive of an entry, or nullptr.
Json* primitiveOf(Json& json, const Json& entry) {
    const size_t mesh = indexIn(entry, "mesh"), primitive = indexIn(entry, "primitive");
    if (mesh >= listOf(json, "meshes").size() || primitive >= listOf(json["meshes"][mesh], "primitives").size()) return nullptr;
    return &json["meshes"][mesh]["primitives"][primitive];
}

size_t usesOfMaterial(const Json& json, size_t material) {
    size_t uses = 0;
    for (const Json& mesh : listOf(json, "meshes"))
        for (const Json& primitive : listOf(mesh, "primitives")) uses += indexIn(primitive, "material") == material;
    return uses;
}

}  // namespace

PngImage bentImage(const BentNormals& bent, int bits) {
    PngImage out{bent.width, bent.height, bits, {}, 3};
    for (const glm::vec4& texel : bent.texels)
        for (int c = 0; c < 3; ++c) out.samples.push_back(code(0.5f + 0.5f * texel[c], bits));
    return out;
}

PngImage occlusionImage(const BentNormals& bent, int bits) {
    PngImage out{bent.width, bent.height, bits, {}, 1};
    for (const glm::vec4& texel : bent.texels) out.samples.push_back(code(texel.w, bits));
    return out;
}

Json addBentNormals(GltfWriter& writer, const Scene& scene, const BakedVisibility& visibility, int bits) {
    Json out;
    Json& json = writer.json();
    size_t sampler = SIZE_MAX;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const BentNormals& bent = visibility[i].bent;
        if (bent.texels.empty()) continue;
        const Instance& instance = scene.instances[i];
        if (sampler == SIZE_MAX) sampler = addSampler(json);
        const size_t mesh = json["nodes"][size_t(instance.node)]["mesh"].get<size_t>();
        const int set = scene.surfaces[size_t(instance.surface)].coordinateSet;
        Json& primitive = json["meshes"][mesh]["primitives"][size_t(instance.primitive)];
        Json entry{{"mesh", mesh}, {"primitive", instance.primitive}, {"texCoord", set}};
        entry["texture"] = addTexture(writer, bentImage(bent, bits), kBentName, sampler);
        entry["occlusion"] = addTexture(writer, occlusionImage(bent, bits), kOcclusionName, sampler);
        Json material = Json::object();
        if (const size_t own = indexIn(primitive, "material"); own != SIZE_MAX) entry["material"] = own, material = json["materials"][own];
        material["occlusionTexture"] = {{"index", entry["occlusion"]}, {"texCoord", set}};
        primitive["material"] = listOf(json, "materials").size();
        json["materials"].push_back(std::move(material));
        if (!bent.tangents.empty()) {
            Bytes bytes(bent.tangents.size() * sizeof(glm::vec4));
            std::memcpy(bytes.data(), bent.tangents.data(), bytes.size());
            primitive["attributes"]["TANGENT"] = writer.addAccessor(
                {{"componentType", kFloat}, {"type", "VEC4"}, {"count", bent.tangents.size()}}, std::move(bytes), kArrayBuffer);
        }
        out.push_back(std::move(entry));
    }
    return out;
}

void removeBentNormals(Json& json, std::set<size_t>& views) {
    Json& baked = json["asset"]["extras"]["apertura"];
    const Json entries = listOf(baked, kEntry);
    baked.erase(kEntry);
    if (!entries.is_array()) return;
    // The last first, as they were added.
    for (size_t e = entries.size(); e-- > 0;) {
        const Json& entry = entries[e];
        Json* primitive = primitiveOf(json, entry);
        const size_t occlusion = indexIn(entry, "occlusion");
        const size_t material = primitive ? indexIn(*primitive, "material") : SIZE_MAX;
        if (occlusion == SIZE_MAX || material == SIZE_MAX) continue;
        // Another material, or another image in it, is somebody else's.
        if (indexIn(listOf(json["materials"][material], "occlusionTexture"), "index") != occlusion) continue;
        if (const size_t own = indexIn(entry, "material"); own < material)
            (*primitive)["material"] = own;
        else
            primitive->erase("material");
        if (material + 1 == json["materials"].size() && usesOfMaterial(json, material) == 0) json["materials"].erase(material);
        removeTexture(json, occlusion, kOcclusionName, views);
        removeTexture(json, indexIn(entry, "texture"), kBentName, views);
    }
    if (json.contains("materials") && json["materials"].empty()) json.erase("materials");
}

int countBentNormals(const Json& described) {
    const Json& entries = listOf(described, kEntry);
    return entries.is_array() ? int(entries.size()) : 0;
}

}  // namespace apertura
