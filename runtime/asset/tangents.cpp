#include "runtime/asset/tangents.h"

#include <array>
#include <cmath>
#include <map>
#include <string>

#include "runtime/asset/gltf_document.h"
#include "runtime/asset/texels.h"

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

std::vector<glm::vec4> makeTangents(const Surface& surface, std::span<const glm::vec2> coordinates) {
    using Corner = std::array<float, 8>;
    std::map<Corner, size_t> byCorner;
    std::vector<size_t> same;  // of each position, one that is the same corner for all of them
    for (size_t v = 0; v < surface.positions.size(); ++v) {
        const glm::vec3 &p = surface.positions[v], &n = surface.normals[v];
        same.push_back(byCorner.try_emplace({p.x, p.y, p.z, n.x, n.y, n.z, coordinates[v].x, coordinates[v].y}, v).first->second);
    }
    std::vector<glm::vec3> sums(surface.positions.size(), glm::vec3(0));
    std::vector<float> signs(surface.positions.size(), 0);
    for (const auto& triangle : surface.triangles) {
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
        for (size_t c = 0; c < 3; ++c) {
            const size_t at = same[triangle[c]];
            const glm::vec3& normal = surface.normals[at];
            const auto [to, from] = edges(c);
            const glm::vec3 first = unitOr(inPlane(to, normal), glm::vec3(0)), second = unitOr(inPlane(from, normal), glm::vec3(0));
            const float angle = std::acos(std::clamp(glm::dot(first, second), -1.0f, 1.0f));
            sums[at] += angle * unitOr(inPlane(growing, normal), glm::vec3(0));
            // Seen from where the normal points, coordinates that turn as the corners do have v, which points down, on the left of u.
            signs[at] += angle * ((area > 0) == (glm::dot(face, normal) > 0) ? -1.0f : 1.0f);
        }
    }
    std::vector<glm::vec4> out;
    for (size_t v = 0; v < surface.positions.size(); ++v)
        out.emplace_back(unitOr(sums[same[v]], across(surface.normals[v])), signs[same[v]] < 0 ? -1.0f : 1.0f);
    return out;
}

std::vector<glm::vec4> tangentsOf(const Scene& scene, size_t instance, bool* made) {
    const Instance& placed = scene.instances[instance];
    const Surface& surface = scene.surfaces[size_t(placed.surface)];
    if (made) *made = true;
    if (!scene.document) return makeTangents(surface, surface.coordinates);
    const GltfDocument& document = *scene.document;
    const size_t mesh = document.json["nodes"][size_t(placed.node)]["mesh"].get<size_t>();
    const Json& primitive = document.json["meshes"][mesh]["primitives"][size_t(placed.primitive)];
    const Json& attributes = primitive["attributes"];
    if (const auto found = attributes.find("TANGENT"); found != attributes.end() && surface.splitFrom.empty()) {
        const std::vector<float> values = readAccessor(document, found->get<size_t>(), 4);
        std::vector<glm::vec4> out;
        for (size_t v = 0; v < surface.positions.size(); ++v) {
            const glm::vec3 own(values.at(4 * v), values.at(4 * v + 1), values.at(4 * v + 2));
            out.emplace_back(unitOr(own, across(surface.normals[v])), values[4 * v + 3] < 0 ? -1.0f : 1.0f);
        }
        if (made) *made = false;
        return out;
    }
    if (!primitive.contains("material")) return makeTangents(surface, surface.coordinates);
    const Json& material = document.json["materials"][primitive["material"].get<size_t>()];
    const Json& normalMap = listOf(material, "normalTexture");
    if (!normalMap.is_object()) return makeTangents(surface, surface.coordinates);
    const size_t said = indexIn(normalMap, "texCoord"), set = said == SIZE_MAX ? 0 : said;
    if (set == size_t(surface.coordinateSet) || !attributes.contains("TEXCOORD_" + std::to_string(set)))
        return makeTangents(surface, surface.coordinates);
    return makeTangents(surface, readCoordinates(document, primitive, set, surface));
}

glm::mat3 tangentFrame(const Surface& surface, std::span<const glm::vec4> tangents, size_t triangle, const glm::vec3& barycentrics) {
    glm::vec3 normal(0), tangent(0);
    float sign = 0;
    for (int c = 0; c < 3; ++c) {
        const uint32_t v = surface.triangles[triangle][size_t(c)];
        normal += barycentrics[c] * surface.normals[v];
        tangent += barycentrics[c] * glm::vec3(tangents[v]);
        sign += barycentrics[c] * tangents[v].w;
    }
    normal = unitOr(normal, surface.normals[surface.triangles[triangle][0]]);
    tangent = unitOr(inPlane(tangent, normal), across(normal));
    return {tangent, (sign < 0 ? -1.0f : 1.0f) * glm::cross(normal, tangent), normal};
}

}  // namespace apertura
