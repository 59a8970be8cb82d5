#include "apertura/runtime/asset/bent_normals.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>

#include "apertura/runtime/asset/tangents.h"
#include "apertura/runtime/asset/texels.h"

namespace apertura {
namespace {

const char* const kEntry = "bentNormals";  // of asset.extras.apertura
const char *const kBentName = "_BENT_NORMAL", *const kOcclusionName = "_OCCLUSION";
// Limit of JSON values that copies of materials may repeat: a base, and more per byte of the file.
constexpr double kFewValues = 0x1p20, kValuesAByte = 32;

// Of numbers 0..1.
uint16_t code(float number, int bits) { return uint16_t(std::lround(std::clamp(number, 0.0f, 1.0f) * float((1 << bits) - 1))); }

size_t addTexture(GltfWriter& writer, const PngImage& image, const char* name, size_t sampler) {
    Json& json = writer.json();
    const size_t view = writer.addView(encodePng(image));
    json["images"].push_back({{"name", name}, {"mimeType", "image/png"}, {"bufferView", view}});
    json["textures"].push_back({{"name", name}, {"sampler", sampler}, {"source", json["images"].size() - 1}});
    return json["textures"].size() - 1;
}

Json withoutOcclusion(Json material) {
    material.erase("occlusionTexture");
    return material;
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
    std::map<int, size_t> tangents;  // by surface, the accessor
    std::optional<Budget> copies;
    if (scene.document) copies.emplace(*scene.document, "the copies of materials that its images need", kFewValues, kValuesAByte);
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
        if (const size_t own = indexIn(primitive, "material"); own != SIZE_MAX) {
            entry["material"] = own, material = json["materials"][own];
            if (copies) copies->spend(valuesIn(material));
        }
        material["occlusionTexture"] = {{"index", entry["occlusion"]}, {"texCoord", set}};
        primitive["material"] = listOf(json, "materials").size();
        json["materials"].push_back(std::move(material));
        if (!bent.tangents.empty()) {
            const auto [accessor, fresh] = tangents.try_emplace(instance.surface);
            if (fresh) {
                Bytes bytes(bent.tangents.size() * sizeof(glm::vec4));
                std::memcpy(bytes.data(), bent.tangents.data(), bytes.size());
                accessor->second = writer.addAccessor(
                    {{"name", kMadeTangents}, {"componentType", kFloat}, {"type", "VEC4"}, {"count", bent.tangents.size()}},
                    std::move(bytes), kArrayBuffer);
            }
            primitive["attributes"]["TANGENT"] = accessor->second;
        }
        out.push_back(std::move(entry));
    }
    return out;
}

void removeBentNormals(Json& json, std::set<size_t>& accessors, std::set<size_t>& views) {
    Json& baked = json["asset"]["extras"]["apertura"];
    const Json entries = listOf(baked, kEntry);
    baked.erase(kEntry);
    std::map<std::pair<size_t, size_t>, size_t> before;  // by mesh and primitive, the material
    if (entries.is_array())
        for (const Json& entry : entries) before[{indexIn(entry, "mesh"), indexIn(entry, "primitive")}] = indexIn(entry, "material");
    Json& meshes = json["meshes"];
    std::map<size_t, size_t> uses;  // of materials
    for (const Json& mesh : meshes)
        for (const Json& primitive : listOf(mesh, "primitives")) ++uses[indexIn(primitive, "material")];
    for (size_t m = meshes.size(); m-- > 0;)
        for (size_t p = listOf(meshes[m], "primitives").size(); p-- > 0;) {
            Json& primitive = meshes[m]["primitives"][p];
            if (const size_t tangents = indexIn(primitive["attributes"], "TANGENT");
                tangents != SIZE_MAX && json["accessors"][tangents].value("name", Json()) == kMadeTangents) {
                accessors.insert(tangents);
                primitive["attributes"].erase("TANGENT");
            }
            const size_t copy = indexIn(primitive, "material");
            if (copy == SIZE_MAX) continue;
            Json& material = json["materials"][copy];
            if (!isImageOf(json, indexIn(listOf(material, "occlusionTexture"), "index"), kOcclusionName)) continue;
            const auto found = before.find({m, p});
            const size_t own = found == before.end() ? SIZE_MAX : found->second;
            const Json rest = withoutOcclusion(material);
            if (own < json["materials"].size() && own != copy && withoutOcclusion(json["materials"][own]) == rest) {
                primitive["material"] = own;
            } else if (found != before.end() && own == SIZE_MAX && rest.empty()) {
                primitive.erase("material");
            } else {
                // Programs have changed the materials since: this one stays, without our image.
                material = rest;
                continue;
            }
            --uses[copy];
        }
    // The copies stand at the end, and have no use now.
    while (!listOf(json, "materials").empty()) {
        const size_t last = json["materials"].size() - 1;
        if (uses[last] > 0 || !isImageOf(json, indexIn(listOf(json["materials"][last], "occlusionTexture"), "index"), kOcclusionName))
            break;
        json["materials"].erase(last);
    }
    if (json.contains("materials") && json["materials"].empty()) json.erase("materials");
    removeTextures(json, {kBentName, kOcclusionName}, views);
}

int countBentNormals(const Json& json, const Json& described) {
    const Json& entries = listOf(described, kEntry);
    if (!entries.is_array()) return 0;
    return int(std::count_if(entries.begin(), entries.end(), [&](const Json& entry) {
        return isImageOf(json, indexIn(entry, "texture"), kBentName) && isImageOf(json, indexIn(entry, "occlusion"), kOcclusionName);
    }));
}

}  // namespace apertura
