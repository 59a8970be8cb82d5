#include "apertura/runtime/asset/materials.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "apertura/runtime/asset/gltf_materials.h"

namespace apertura {
namespace {

// What a texture of a material says beside its image.
struct Place {
    int set = 0;                                     // TEXCOORD_
    glm::dvec2 offset{0}, scale{1}, rotation{1, 0};  // cosine, sine

    glm::vec2 of(const glm::dvec2& uv) const {
        const glm::dvec2 p = uv * scale;
        return offset + glm::dvec2(rotation.x * p.x + rotation.y * p.y, rotation.x * p.y - rotation.y * p.x);
    }
};

// Members that may be missing or of any type: a broken one counts as missing.
const Json& memberOf(const Json& object, const char* key) {
    static const Json none;
    const auto found = object.is_object() ? object.find(key) : object.end();
    return object.is_object() && found != object.end() ? *found : none;
}
double numberOf(const Json& value, double fallback) {
    const double x = value.is_number() ? value.get<double>() : fallback;
    return std::abs(x) < 1e6 ? x : fallback;
}
template <int N>
glm::vec<N, double> numbersOf(const Json& value, glm::vec<N, double> fallback) {
    if (!value.is_array() || value.size() != size_t(N)) return fallback;
    for (int c = 0; c < N; ++c) fallback[c] = numberOf(value[size_t(c)], fallback[c]);
    return fallback;
}
int indexOf(const Json& value, size_t count) {
    return value.is_number_unsigned() && value.get<uint64_t>() < count ? int(value.get<uint64_t>()) : -1;
}

Place placeOf(const Json& texture) {
    Place out;
    const Json& transform = memberOf(memberOf(texture, "extensions"), "KHR_texture_transform");
    out.set = std::max(indexOf(memberOf(transform, "texCoord"), 16), -1);
    if (out.set < 0) out.set = std::max(indexOf(memberOf(texture, "texCoord"), 16), 0);
    out.offset = numbersOf<2>(memberOf(transform, "offset"), out.offset);
    out.scale = numbersOf<2>(memberOf(transform, "scale"), out.scale);
    const double angle = numberOf(memberOf(transform, "rotation"), 0);
    out.rotation = {std::cos(angle), std::sin(angle)};
    return out;
}

Texture::Wrap wrapOf(const Json& value) {
    switch (value.is_number_unsigned() ? value.get<uint64_t>() : 10497) {
        case 33071: return Texture::Wrap::Clamp;
        case 33648: return Texture::Wrap::Mirror;
        default: return Texture::Wrap::Repeat;
    }
}

const Json& baseOf(const Json& material) { return memberOf(memberOf(material, "pbrMetallicRoughness"), "baseColorTexture"); }

// Numbers of an attribute of floats or normalised integers; empty if it is anything else.
std::vector<float> attributeOf(const GltfDocument& document, const Json& primitive, const std::string& name, const char* type,
                               int components, size_t vertices) {
    const Json& attribute = memberOf(memberOf(primitive, "attributes"), name.c_str());
    if (!attribute.is_number_unsigned() || document.json["accessors"][attribute.get<size_t>()]["type"] != type) return {};
    std::vector<float> out = readAccessor(document, attribute.get<size_t>(), components);
    if (out.size() != vertices * size_t(components)) out.clear();
    return out;
}

}  // namespace

void readMaterials(Scene& scene) {
    const Json& json = scene.document->json;
    for (const Json& texture : listOf(json, "textures")) {
        auto out = std::make_shared<Texture>();
        const Json& samplers = listOf(json, "samplers");
        if (const int sampler = indexOf(memberOf(texture, "sampler"), samplers.size()); sampler >= 0) {
            out->wrapU = wrapOf(memberOf(samplers[size_t(sampler)], "wrapS"));
            out->wrapV = wrapOf(memberOf(samplers[size_t(sampler)], "wrapT"));
            out->nearest = memberOf(samplers[size_t(sampler)], "magFilter") == 9728;
        }
        scene.textures.push_back(std::move(out));
    }
    for (const Json& material : listOf(json, "materials")) {
        Material out;
        const Json& pbr = memberOf(material, "pbrMetallicRoughness");
        out.baseColour = glm::clamp(numbersOf<4>(memberOf(pbr, "baseColorFactor"), glm::dvec4(1)), 0.0, 1.0);
        out.baseTexture = indexOf(memberOf(baseOf(material), "index"), scene.textures.size());
        const double strength = numberOf(
            memberOf(memberOf(memberOf(material, "extensions"), "KHR_materials_emissive_strength"), "emissiveStrength"), 1);
        out.emissive = glm::max(numbersOf<3>(memberOf(material, "emissiveFactor"), glm::dvec3(0)), 0.0) * std::max(strength, 0.0);
        out.emissiveTexture = indexOf(memberOf(memberOf(material, "emissiveTexture"), "index"), scene.textures.size());
        const Json& mode = memberOf(material, "alphaMode");
        out.alpha = mode == "MASK" ? Material::Alpha::Mask : mode == "BLEND" ? Material::Alpha::Blend : Material::Alpha::Opaque;
        out.cutoff = float(numberOf(memberOf(material, "alphaCutoff"), 0.5));
        scene.materials.push_back(out);
    }
}

std::vector<VertexPaint> readPaint(const Scene& scene, const Json& primitive, size_t vertices) {
    const GltfDocument& document = *scene.document;
    static const Json none;
    const Json& index = memberOf(primitive, "material");
    const Json& material = index.is_number_unsigned() ? document.json["materials"][index.get<size_t>()] : none;
    std::vector<VertexPaint> out;
    const auto place = [&](const Json& texture, glm::vec2 VertexPaint::*at) {
        if (indexOf(memberOf(texture, "index"), scene.textures.size()) < 0) return;
        const Place in = placeOf(texture);
        const std::vector<float> values = attributeOf(document, primitive, "TEXCOORD_" + std::to_string(in.set), "VEC2", 2, vertices);
        out.resize(vertices);
        for (size_t v = 0; v < vertices && !values.empty(); ++v) out[v].*at = in.of({values[2 * v], values[2 * v + 1]});
    };
    place(baseOf(material), &VertexPaint::base);
    place(memberOf(material, "emissiveTexture"), &VertexPaint::emissive);
    for (const int components : {3, 4}) {
        const std::vector<float> values = attributeOf(document, primitive, "COLOR_0", components == 3 ? "VEC3" : "VEC4", components,
                                                      vertices);
        if (values.empty()) continue;
        out.resize(vertices);
        for (size_t v = 0; v < vertices; ++v)
            for (int c = 0; c < components; ++c) {
                const float value = values[v * size_t(components) + size_t(c)];
                out[v].colour[c] = value >= 0 && value <= 1 ? value : value > 1 ? 1.0f : 0.0f;  // a NaN is 0
            }
    }
    return out;
}

}  // namespace apertura
