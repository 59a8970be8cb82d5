#include "apertura/runtime/asset/tangents.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/gltf_document.h"
#include "apertura/runtime/asset/texels.h"

namespace apertura {
namespace {

// Any unit vector across a unit one.
glm::vec3 across(const glm::vec3& n) {
    return glm::normalize(glm::cross(n, std::abs(n.x) < 0.7f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0)));
}

glm::vec3 inPlane(const glm::vec3& v, const glm::vec3& normal) { return v - glm::dot(v, normal) * normal; }

glm::vec3 unitOr(const glm::vec3& v, const glm::vec3& fallback) {
    const float length = glm::length(v);
    return length > 1e-20f && std::isfinite(length) ? v / length : fallback;
}

}  // namespace

const char* const kMadeTangents = "apertura tangents";

Tangents makeTangents(const Surface& surface, std::span<const glm::vec2> coordinates) {
    using Corner = std::array<float, 8>;
    std::map<Corner, size_t> byCorner;
    std::vector<size_t> same;  // of each position, one that is the same corner for all of them
    for (size_t v = 0; v < surface.positions.size(); ++v) {
        const glm::vec3 &p = surface.positions[v], &n = surface.normals[v];
        same.push_back(byCorner.try_emplace({p.x, p.y, p.z, n.x, n.y, n.z, coordinates[v].x, coordinates[v].y}, v).first->second);
    }
    std::vector<glm::vec3> sums[2];  // of those that turn with the surface, and against it
    for (auto& sum : sums) sum.assign(surface.positions.size(), glm::vec3(0));
    std::vector<uint8_t> against(surface.triangles.size(), 0);
    for (size_t t = 0; t < surface.triangles.size(); ++t) {
        const auto& triangle = surface.triangles[t];
        const auto edges = [&](size_t c) {
            const uint32_t at = triangle[c], next = triangle[(c + 1) % 3], last = triangle[(c + 2) % 3];
            return std::array{surface.positions[next] - surface.positions[at], surface.positions[last] - surface.positions[at]};
        };
        const glm::dvec2 a = coordinates[triangle[1]] - coordinates[triangle[0]], b = coordinates[triangle[2]] - coordinates[triangle[0]];
        const double area = a.x * b.y - a.y * b.x;
        if (area == 0) continue;
        const auto [along, beside] = edges(0);
        const auto growing = glm::vec3((b.y * glm::dvec3(along) - a.y * glm::dvec3(beside)) / area);  // the derivative by u
        const glm::vec3 face = glm::cross(along, beside);
        const glm::vec3 side = surface.normals[triangle[0]] + surface.normals[triangle[1]] + surface.normals[triangle[2]];
        // Seen from where the normals point, coordinates that turn as the corners do have v, which points down, on the left of u.
        against[t] = (area > 0) == (glm::dot(face, side) >= 0);
        for (size_t c = 0; c < 3; ++c) {
            const size_t at = same[triangle[c]];
            const glm::vec3& normal = surface.normals[at];
            const auto [to, from] = edges(c);
            const glm::vec3 first = unitOr(inPlane(to, normal), glm::vec3(0)), second = unitOr(inPlane(from, normal), glm::vec3(0));
            const float angle = std::acos(std::clamp(glm::dot(first, second), -1.0f, 1.0f));
            sums[against[t]][at] += angle * unitOr(inPlane(growing, normal), glm::vec3(0));
        }
    }
    Tangents out;
    for (size_t t = 0; t < surface.triangles.size(); ++t) {
        auto& corners = out.emplace_back();
        for (size_t c = 0; c < 3; ++c) {
            const uint32_t v = surface.triangles[t][c];
            corners[c] = glm::vec4(unitOr(sums[against[t]][same[v]], across(surface.normals[v])), against[t] ? -1.0f : 1.0f);
        }
    }
    return out;
}

namespace {

Tangents spread(const Surface& surface, const std::vector<glm::vec4>& atPositions) {
    Tangents out;
    for (const auto& t : surface.triangles) out.push_back({atPositions[t[0]], atPositions[t[1]], atPositions[t[2]]});
    return out;
}

// The set of coordinates of a texture in a material: KHR_texture_transform may name another.
size_t setOf(const Json& texture) {
    const size_t moved = indexIn(listOf(listOf(texture, "extensions"), "KHR_texture_transform"), "texCoord");
    const size_t said = moved == SIZE_MAX ? indexIn(texture, "texCoord") : moved;
    return said == SIZE_MAX ? 0 : said;
}

// The tangents of a file, one per position.
std::vector<glm::vec4> readTangents(const Scene& scene, size_t accessor, const std::string& where) {
    std::vector<glm::vec4> out;
    const std::vector<float> values = readAccessor(*scene.document, accessor, 4);
    for (size_t v = 0; v + 3 < values.size(); v += 4) {
        const glm::vec3 own(values[v], values[v + 1], values[v + 2]);
        const float length = glm::length(own);
        if (!(std::abs(length - 1) < 0.1f)) throw Error(where + ": its tangents are no unit vectors");
        out.emplace_back(own / length, values[v + 3] < 0 ? -1.0f : 1.0f);
    }
    return out;
}

}  // namespace

Tangents tangentsOf(const Scene& scene, size_t instance, std::vector<glm::vec4>* toStore) {
    const Instance& placed = scene.instances[instance];
    const Surface& surface = scene.surfaces[size_t(placed.surface)];
    const auto made = [&] {
        Tangents out = makeTangents(surface, surface.coordinates);
        if (!toStore) return out;
        // Vertices that no triangle uses have any tangent. Where coordinates do not lie over each other no vertex has two.
        for (const glm::vec3& normal : surface.normals) toStore->emplace_back(across(normal), 1);
        for (size_t t = 0; t < out.size(); ++t)
            for (size_t c = 0; c < 3; ++c) (*toStore)[surface.triangles[t][c]] = out[t][c];
        return out;
    };
    if (!scene.document) return made();
    const GltfDocument& document = *scene.document;
    const size_t mesh = document.json["nodes"][size_t(placed.node)]["mesh"].get<size_t>();
    const std::string where = scene.name + ": mesh " + std::to_string(mesh);
    const Json& primitive = document.json["meshes"][mesh]["primitives"][size_t(placed.primitive)];
    const Json& attributes = primitive["attributes"];
    if (const size_t own = indexIn(attributes, "TANGENT");
        own != SIZE_MAX && surface.splitFrom.empty() && document.json["accessors"][own].value("name", Json()) != kMadeTangents)
        return spread(surface, readTangents(scene, own, where));
    if (!primitive.contains("material")) return made();
    const Json& normalMap = listOf(document.json["materials"][primitive["material"].get<size_t>()], "normalTexture");
    if (!normalMap.is_object()) return made();
    const size_t set = setOf(normalMap);
    if (set == size_t(surface.coordinateSet)) return makeTangents(surface, surface.coordinates);
    if (!attributes.contains("TEXCOORD_" + std::to_string(set)))
        throw Error(where + ": its normal map lies over texture coordinates that it does not have");
    return makeTangents(surface, readCoordinates(document, primitive, set, surface));
}

glm::mat3 tangentFrame(const Surface& surface, const Tangents& tangents, size_t triangle, const glm::vec3& barycentrics) {
    glm::vec3 normal(0), tangent(0);
    float sign = 0;
    for (int c = 0; c < 3; ++c) {
        const glm::vec4& own = tangents[triangle][size_t(c)];
        normal += barycentrics[c] * surface.normals[surface.triangles[triangle][size_t(c)]];
        tangent += barycentrics[c] * glm::vec3(own);
        sign += barycentrics[c] * own.w;
    }
    normal = unitOr(normal, surface.normals[surface.triangles[triangle][0]]);
    tangent = unitOr(inPlane(tangent, normal), across(normal));
    return {tangent, (sign < 0 ? -1.0f : 1.0f) * glm::cross(normal, tangent), normal};
}

}  // namespace apertura
