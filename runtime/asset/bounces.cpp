#include "apertura/runtime/asset/bounces.h"

#include <algorithm>
#include <locale>
#include <optional>
#include <sstream>

#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/primitive.h"
#include "apertura/sh/packing.h"

namespace apertura {
namespace {

const char* const kShare = "_BOUNCE";
const char* const kTowards = "_BOUNCE_TOWARDS";
const char* const kShareOnFaces = "_BOUNCE_SAMPLES";
const char* const kTowardsOnFaces = "_BOUNCE_TOWARDS_SAMPLES";
constexpr size_t kStride = 4;  // of an attribute: glTF 2.0, 3.7.2.1

// Adds the bytes of all: the shares, and the directions. `stride`: 3, or 4 with a byte of padding.
void append(Bytes& shares, Bytes& towards, const std::vector<AperturaBounce>& bounces, const glm::mat3& rotation, size_t stride) {
    const glm::mat3 toLocal = glm::transpose(rotation);
    for (const AperturaBounce& b : bounces) {
        const PackedBounce packed = pack(AperturaBounce{b.share, toLocal * b.towards});
        for (size_t c = 0; c < stride; ++c) {
            shares.push_back(c < 3 ? packed.share[c] : 0);
            towards.push_back(c < 3 ? static_cast<unsigned char>(packed.towards[c]) : 0);
        }
    }
}

Json members(GltfComponent component, size_t count) {
    return {{"componentType", component}, {"normalized", true}, {"type", "VEC3"}, {"count", count}};
}

// The numbers of an accessor; nothing unless it has `count` elements of this kind.
std::optional<std::vector<float>> numbersOf(const GltfDocument& document, size_t accessor, GltfComponent component, size_t count) {
    const Json& json = document.json["accessors"][accessor];
    if (json["componentType"] != component || !json.value("normalized", false) || json.value("type", "") != "VEC3"
        || accessorCount(document, accessor) != count)
        return std::nullopt;
    return readAccessor(document, accessor, 3);
}

std::vector<AperturaBounce> unpackAll(const std::vector<float>& shares, const std::vector<float>& towards) {
    std::vector<AperturaBounce> out;
    for (size_t k = 0; k + 2 < shares.size(); k += 3)
        out.push_back(unpackBounce({shares[k], shares[k + 1], shares[k + 2]}, {towards[k], towards[k + 1], towards[k + 2]}));
    return out;
}

void turn(std::vector<AperturaBounce>& bounces, const glm::mat3& rotation) {
    for (AperturaBounce& b : bounces) b.towards = rotation * b.towards;
}

// The bounces at an instance's vertices; nothing if they are missing or damaged.
std::optional<std::vector<AperturaBounce>> atVertices(const GltfDocument& document, const Json& attributes, size_t vertices,
                                                      const std::vector<uint32_t>& splitFrom) {
    if (!attributes.contains(kShare) || !attributes.contains(kTowards)) return std::nullopt;
    const size_t share = attributes[kShare].get<size_t>(), count = accessorCount(document, share);
    const auto shares = numbersOf(document, share, kUnsignedByte, count);
    const auto towards = numbersOf(document, attributes[kTowards].get<size_t>(), kByte, count);
    if (!shares || !towards) return std::nullopt;
    std::vector<AperturaBounce> all = unpackAll(*shares, *towards);
    if (!pick(all, splitFrom) || all.size() != vertices) return std::nullopt;
    return all;
}

}  // namespace

void addBounces(GltfWriter& writer, Json& primitive, const std::vector<AperturaBounce>& bounces, const glm::mat3& rotation) {
    Bytes shares, towards;
    append(shares, towards, bounces, rotation, kStride);
    primitive["attributes"][kShare] = writer.addAccessor(members(kUnsignedByte, bounces.size()), std::move(shares), kArrayBuffer, kStride);
    primitive["attributes"][kTowards] = writer.addAccessor(members(kByte, bounces.size()), std::move(towards), kArrayBuffer, kStride);
}

void addBouncesOnFaces(GltfWriter& writer, const Scene& scene, const BakedVisibility& seen) {
    Bytes shares, towards;
    for (size_t i = 0; i < seen.size(); ++i) append(shares, towards, seen[i].faces.bounces, rotationPart(scene.instances[i].toWorld), 3);
    if (shares.empty()) return;
    const size_t count = shares.size() / 3;
    const auto add = [&](const char* name, GltfComponent component, Bytes bytes) {
        Json json = members(component, count);
        json["name"] = name;
        writer.addAccessor(std::move(json), std::move(bytes), kNoTarget);
    };
    add(kShareOnFaces, kUnsignedByte, std::move(shares));
    add(kTowardsOnFaces, kByte, std::move(towards));
}

std::set<size_t> removeBounces(Json& json) {
    std::set<size_t> out;
    if (json.contains("meshes"))
        for (Json& mesh : json["meshes"]) {
            if (!mesh.contains("primitives")) continue;
            for (Json& primitive : mesh["primitives"])
                for (const char* name : {kShare, kTowards})
                    if (const auto found = primitive["attributes"].find(name); found != primitive["attributes"].end()) {
                        out.insert(found->get<size_t>());
                        primitive["attributes"].erase(found);
                    }
        }
    const char* const names[] = {kShareOnFaces, kTowardsOnFaces};
    out.merge(takeNames(json, names));
    return out;
}

void readBounces(Asset& asset) {
    const Scene& scene = asset.scene;
    const GltfDocument& document = *scene.document;
    const auto without = [&](const char* why) {
        for (SeenByInstance& seen : asset.seen) seen.bounces.clear(), seen.faces.bounces.clear();
        asset.info.bounce.clear();
        asset.scene.notes.push_back(std::string("what its surfaces reflect ") + why + ": light that bounces is estimated from visibility");
    };
    if (asset.info.bounce.empty()) return;
    if (hasTexels(asset)) return without("has no place in images");
    size_t samples = 0;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const Json& primitive = primitiveOf(document, instance);
        SeenByInstance& seen = asset.seen[i];
        auto own = atVertices(document, primitive["attributes"], seen.visibility.size(),
                              scene.surfaces[size_t(instance.surface)].splitFrom);
        if (!own) return without("is gone or does not fit its vertices");
        seen.bounces = std::move(*own);
        turn(seen.bounces, rotationPart(instance.toWorld));
        samples += seen.faces.visibility.size();
    }
    if (samples == 0) return;
    const std::optional<size_t> shareAt = findAccessor(document.json, kShareOnFaces),
                                towardsAt = findAccessor(document.json, kTowardsOnFaces);
    if (!shareAt || !towardsAt) return without("is gone from its faces");
    const auto shares = numbersOf(document, *shareAt, kUnsignedByte, samples), towards = numbersOf(document, *towardsAt, kByte, samples);
    if (!shares || !towards) return without("does not fit its samples on faces");
    const std::vector<AperturaBounce> all = unpackAll(*shares, *towards);
    auto next = all.begin();
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        SeenOnFaces& faces = asset.seen[i].faces;
        const auto count = ptrdiff_t(faces.visibility.size());
        faces.bounces.assign(next, next + count);
        turn(faces.bounces, rotationPart(scene.instances[i].toWorld));
        next += count;
    }
}

bool hasBounces(const Asset& asset) {
    return std::any_of(asset.seen.begin(), asset.seen.end(), [](const SeenByInstance& seen) { return !seen.bounces.empty(); });
}

std::optional<glm::vec3> bakedAlbedo(const BakeInfo& info) {
    std::istringstream in(info.bounce);
    in.imbue(std::locale::classic());
    glm::vec3 out;
    char comma = 0;
    if (!(in >> out.x)) return std::nullopt;
    if (in >> comma) {
        if (!(in >> out.y >> comma >> out.z)) return std::nullopt;
    } else {
        out.y = out.z = out.x;
    }
    const auto isAlbedo = [](float a) { return a >= 0 && a <= 1; };
    if (!isAlbedo(out.x) || !isAlbedo(out.y) || !isAlbedo(out.z)) return std::nullopt;
    return out;
}

int bounceSourceOf(const View& view, const Asset& asset) {
    if (view.bounces == 0) return APERTURA_BOUNCES_NONE;
    if (view.around == View::Around::Own) return APERTURA_BOUNCES_OWN;
    const bool isBaked = view.around == View::Around::Baked && hasBounces(asset) && (!view.plain || bakedAlbedo(asset.info) == view.albedo);
    return isBaked ? APERTURA_BOUNCES_BAKED : APERTURA_BOUNCES_GIVEN;
}

size_t bytesOfBounces(const Asset& asset) {
    size_t out = 0;
    for (const SeenByInstance& seen : asset.seen) out += 2 * kStride * seen.bounces.size() + 6 * seen.faces.bounces.size();
    return out;
}

}  // namespace apertura
