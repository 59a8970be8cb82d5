#include "apertura/runtime/asset/model_numbers.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "apertura/runtime/asset/hashes.h"
#include "apertura/runtime/asset/params_stream.h"
#include "apertura/runtime/asset/primitive.h"

namespace apertura {
namespace {

const char* const kAttribute = "_VISIBILITY_NUMBERS_";
const char* const kChoices = "_VISIBILITY_CHOICES";
constexpr int kTogether = 4;  // numbers of an attribute

int attributesOf(const Model& model) { return (int(storedNumbers(model)) + kTogether - 1) / kTogether; }

// The numbers of attribute `k`.
int numbersOf(const Model& model, int k) { return std::min(int(storedNumbers(model)) - k * kTogether, kTogether); }

size_t strideOf(int numbers, int bits) { return (size_t(numbers * bits / 8) + 3) / 4 * 4; }  // glTF 2.0, 3.7.2.1

std::string nameOf(int attribute) { return kAttribute + std::to_string(attribute); }

Bytes bytesOf(const Model& model, const std::vector<ModelParams>& allParams, const glm::mat3& rotation, int bits) {
    const std::vector<std::byte> packed = packAllParams(model, allParams, glm::transpose(rotation), bits);
    Bytes out(packed.size());
    std::transform(packed.begin(), packed.end(), out.begin(), [](std::byte b) { return static_cast<unsigned char>(b); });
    return out;
}

// The bytes of params_stream.h in a primitive's attributes; nothing if they are missing, or are not such numbers.
std::optional<Bytes> streamOf(const GltfDocument& document, const Json& attributes, const Model& model, int bits) {
    std::vector<std::vector<float>> all;
    size_t count = 0;
    for (int k = 0; k < attributesOf(model); ++k) {
        if (!attributes.contains(nameOf(k))) return std::nullopt;
        const auto index = attributes[nameOf(k)].get<size_t>();
        const Json& json = document.json["accessors"][index];
        const char* const types[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
        const int numbers = numbersOf(model, k);
        if (json["componentType"] != (bits == 16 ? kShort : kByte) || !json.value("normalized", false)
            || json.value("type", "") != types[numbers - 1])
            return std::nullopt;
        all.push_back(readAccessor(document, index, numbers));
        const size_t own = all.back().size() / size_t(numbers);
        if (k > 0 && own != count) return std::nullopt;
        count = own;
    }
    Bytes out;
    const float top = bits == 16 ? 32767 : 127;
    for (size_t i = 0; i < count; ++i)
        for (int k = 0; k < int(all.size()); ++k)
            for (int c = 0; c < numbersOf(model, k); ++c) {
                const auto n = uint16_t(int16_t(std::lround(all[size_t(k)][i * size_t(numbersOf(model, k)) + size_t(c)] * top)));
                out.push_back(static_cast<unsigned char>(n & 255));
                if (bits == 16) out.push_back(static_cast<unsigned char>(n >> 8));
            }
    return out;
}

// The buffer view that an asset of 0.1 names for each primitive; the key is mesh and primitive.
std::map<std::pair<size_t, size_t>, size_t> viewsOf01(const GltfDocument& document, const Json& described) {
    std::map<std::pair<size_t, size_t>, size_t> out;
    const Json& list = listOf(described, "forms");
    if (!list.is_array()) return out;
    for (const Json& entry : list) {
        const auto index = [&](const char* key) {
            return entry.is_object() && entry.contains(key) && entry[key].is_number_unsigned() ? entry[key].get<size_t>() : SIZE_MAX;
        };
        if (index("bufferView") < listOf(document.json, "bufferViews").size())
            out[{index("mesh"), index("primitive")}] = index("bufferView");
    }
    return out;
}

// What auto chose, and the bytes of each instance in it. Throws Error with the cause if it is gone or belongs to something else.
std::pair<Bytes, std::vector<size_t>> choicesIn(const Asset& asset, const Json& said, std::span<const std::vector<glm::vec4>> atVertices) {
    const GltfDocument& document = *asset.scene.document;
    const std::optional<size_t> at = findAccessor(document.json, kChoices);
    if (!at) throw Error("are gone");
    if (listOf(said, "vertices") != hashOfPoints(asset.scene, atVertices, asset.info.bits, HashOrder::VerticesInFile))
        throw Error("belong to other vertices, or to these in another order");
    const Json& accessor = document.json["accessors"][*at];
    if (accessor["componentType"] != kUnsignedByte || accessor.value("normalized", false) || accessor.value("type", "") != "SCALAR")
        throw Error("are not bytes");
    std::pair<Bytes, std::vector<size_t>> out;
    for (const float byte : readAccessor(document, *at, 1)) out.first.push_back(static_cast<unsigned char>(byte));
    Hash hash;
    hash.add(out.first);
    const Json& lengths = listOf(said, "numbers");
    if (listOf(said, "bytes") != hash.text() || !lengths.is_array() || lengths.size() != asset.seen.size())
        throw Error("are not those that were baked");
    size_t left = out.first.size();
    for (const Json& length : lengths) {
        out.second.push_back(length.is_number_unsigned() ? length.get<size_t>() : SIZE_MAX);
        if (out.second.back() > left) throw Error("end too soon");
        left -= out.second.back();
    }
    return out;
}

void unpackInto(Asset& asset, size_t i, const Model& stored, std::span<const unsigned char> bytes) {
    const Instance& instance = asset.scene.instances[i];
    const GltfDocument& document = *asset.scene.document;
    const size_t vertices = accessorCount(document, primitiveOf(document, instance)["attributes"]["_VISIBILITY"].get<size_t>());
    std::vector<ModelParams>& own = asset.seen[i].allParams;
    own = unpackAllParams(stored, bytes, vertices, rotationPart(instance.toWorld), asset.info.bits, asset.info.packing);
    if (!pick(own, asset.scene.surfaces[size_t(instance.surface)].splitFrom)) throw Error("are fewer than vertices");
}

// Throws Error with the cause.
void readAll(Asset& asset, const Model& stored, const Json& described, std::span<const std::vector<glm::vec4>> atVertices) {
    const GltfDocument& document = *asset.scene.document;
    const auto views = viewsOf01(document, described);
    if (stored.kind == ModelKind::Choice && views.empty()) {
        const auto [bytes, lengths] = choicesIn(asset, listOf(described, "choices"), atVertices);
        std::span<const unsigned char> left = bytes;
        for (size_t i = 0; i < lengths.size(); ++i) {
            unpackInto(asset, i, stored, left.first(lengths[i]));
            left = left.subspan(lengths[i]);
        }
        return;
    }
    for (size_t i = 0; i < asset.seen.size(); ++i) {
        const Instance& instance = asset.scene.instances[i];
        const Json& attributes = primitiveOf(document, instance)["attributes"];
        if (stored.kind != ModelKind::Choice)
            if (const std::optional<Bytes> own = streamOf(document, attributes, stored, asset.info.bits)) {
                unpackInto(asset, i, stored, *own);
                continue;
            }
        const auto view = views.find({meshOf(document.json, instance), size_t(instance.primitive)});
        if (view == views.end())
            throw Error(attributes.contains(nameOf(0)) ? "are not of the kind or the number that they should be" : "are gone");
        unpackInto(asset, i, stored, viewBytes(document, view->second));
    }
}

}  // namespace

void addNumbers(GltfWriter& writer, Json& primitive, const Model& stored, const SeenByInstance& seen, const glm::mat3& rotation, int bits) {
    if (stored.kind == ModelKind::Choice) return;
    const Bytes bytes = bytesOf(stored, seen.allParams, rotation, bits);
    const size_t width = size_t(bits / 8), point = size_t(storedNumbers(stored)) * width;
    for (int k = 0; k < attributesOf(stored); ++k) {
        const int numbers = numbersOf(stored, k);
        const size_t stride = strideOf(numbers, bits);
        Bytes own(seen.allParams.size() * stride);
        for (size_t i = 0; i < seen.allParams.size(); ++i)
            std::copy_n(bytes.begin() + ptrdiff_t(i * point + size_t(k * kTogether) * width), size_t(numbers) * width,
                        own.begin() + ptrdiff_t(i * stride));
        const char* const types[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
        primitive["attributes"][nameOf(k)] = writer.addAccessor({{"componentType", bits == 16 ? kShort : kByte},
                                                                 {"normalized", true},
                                                                 {"type", types[numbers - 1]},
                                                                 {"count", seen.allParams.size()}},
                                                                std::move(own), kArrayBuffer,
                                                                stride == size_t(numbers) * width ? 0 : stride);
    }
}

Json addChoices(GltfWriter& writer, const Scene& scene, const BakedVisibility& seen, const Model* stored, int bits) {
    if (!stored || stored->kind != ModelKind::Choice) return {};
    Bytes all;
    Json lengths = Json::array();
    std::vector<std::vector<glm::vec4>> atVertices;
    for (size_t i = 0; i < seen.size(); ++i) {
        const glm::mat3 rotation = rotationPart(scene.instances[i].toWorld);
        const Bytes own = bytesOf(*stored, seen[i].allParams, rotation, bits);
        all.insert(all.end(), own.begin(), own.end());
        lengths.push_back(own.size());
        atVertices.push_back(numbersInFile(seen[i].visibility, rotation, bits));
    }
    Hash hash;
    hash.add(all);
    const size_t count = all.size();
    writer.addAccessor({{"name", kChoices}, {"componentType", kUnsignedByte}, {"type", "SCALAR"}, {"count", count}}, std::move(all),
                       kNoTarget);
    return {{"vertices", hashOfPoints(scene, atVertices, bits, HashOrder::Vertices)}, {"bytes", hash.text()}, {"numbers", lengths}};
}

ReleasedNumbers removeNumbers(Json& json) {
    ReleasedNumbers out;
    if (json.contains("meshes"))
        for (Json& mesh : json["meshes"]) {
            if (!mesh.contains("primitives")) continue;
            for (Json& primitive : mesh["primitives"])
                for (auto it = primitive["attributes"].begin(); it != primitive["attributes"].end();) {
                    if (!it.key().starts_with(kAttribute)) {
                        ++it;
                        continue;
                    }
                    out.accessors.insert(it->get<size_t>());
                    it = primitive["attributes"].erase(it);
                }
        }
    const char* const names[] = {kChoices};
    out.accessors.merge(takeNames(json, names));
    const Json& baked = listOf(listOf(json["asset"], "extras"), "apertura");
    for (const Json& entry : listOf(baked, "forms"))
        if (entry.is_object() && entry.contains("bufferView") && entry["bufferView"].is_number_unsigned()
            && entry["bufferView"] < listOf(json, "bufferViews").size())
            out.views.insert(entry["bufferView"].get<size_t>());
    if (baked.is_object()) json["asset"]["extras"]["apertura"].erase("forms");
    return out;
}

void readNumbers(Asset& asset, const Json& described, std::span<const std::vector<glm::vec4>> atVertices) {
    const Model* stored = storedModel(asset.info);
    if (!stored) return;
    try {
        readAll(asset, *stored, described, atVertices);
    } catch (const Error& e) {
        std::string cause = e.what();
        if (const std::string name = asset.scene.name + ": "; cause.starts_with(name))
            cause = "cannot be read: " + cause.substr(name.size());
        for (SeenByInstance& seen : asset.seen) seen.allParams.clear(), seen.faces.allParams.clear();
        asset.scene.notes.push_back("its numbers of the model " + asset.info.model + " " + cause + ": the four numbers alone are used");
        asset.info.model = "sh";
    }
}

size_t bytesOfNumbers(const Model* stored, const std::vector<ModelParams>& allParams, int bits, bool asAttributes) {
    if (!stored) return 0;
    size_t out = 0;
    if (stored->kind == ModelKind::Choice) {
        for (const ModelParams& params : allParams) out += 1 + size_t(storedNumbers(chosenModel(*stored, params)) * bits / 8);
        return out;
    }
    if (!asAttributes) return allParams.size() * size_t(storedNumbers(*stored) * bits / 8);
    for (int k = 0; k < attributesOf(*stored); ++k) out += strideOf(numbersOf(*stored, k), bits);
    return out * allParams.size();
}

}  // namespace apertura
