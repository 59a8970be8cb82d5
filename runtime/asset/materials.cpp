#include "apertura/runtime/asset/materials.h"

#include <algorithm>
#include <cmath>

namespace apertura {
namespace {

VertexPaint paintAt(const Surface& surface, size_t triangle, const glm::vec3& barycentrics) {
    VertexPaint out;
    if (surface.paint.empty()) return out;
    out.colour = glm::vec4(0);
    for (int c = 0; c < 3; ++c) {
        const VertexPaint& corner = surface.paint[surface.triangles[triangle][size_t(c)]];
        out.base += barycentrics[c] * corner.base;
        out.emissive += barycentrics[c] * corner.emissive;
        out.colour += barycentrics[c] * corner.colour;
    }
    return out;
}

// The mip in which `spread` metres are a texel.
float levelOf(const Surface& surface, size_t triangle, const Texture& texture, glm::vec2 VertexPaint::*place, float spread) {
    if (spread <= 0 || surface.paint.empty() || !texture.mips) return 0;
    const std::array<uint32_t, 3>& t = surface.triangles[triangle];
    const auto uv = [&](size_t k) {
        return glm::dvec2(surface.paint[t[k]].*place) * glm::dvec2(texture.mips->front().width, texture.mips->front().height);
    };
    const glm::dvec2 a = uv(1) - uv(0), b = uv(2) - uv(0);
    const glm::dvec3 p(surface.positions[t[0]]), q = glm::dvec3(surface.positions[t[1]]) - p, r = glm::dvec3(surface.positions[t[2]]) - p;
    const double texels = std::abs(a.x * b.y - a.y * b.x), metres = glm::length(glm::cross(q, r));
    if (!(texels > 0 && metres > 0)) return 0;
    return float(std::max(std::log2(double(spread) * std::sqrt(texels / metres)), 0.0));
}

}  // namespace

const Material& materialOf(const Scene& scene, const Surface& surface) {
    static const Material none;
    return surface.material >= 0 ? scene.materials[size_t(surface.material)] : none;
}

glm::vec4 baseColourAt(const Scene& scene, const Surface& surface, size_t triangle, const glm::vec3& barycentrics, float spread) {
    const Material& material = materialOf(scene, surface);
    const VertexPaint paint = paintAt(surface, triangle, barycentrics);
    glm::vec4 out = material.baseColour * paint.colour;
    if (material.baseTexture >= 0) {
        const Texture& texture = *scene.textures[size_t(material.baseTexture)];
        out *= texture.at(paint.base, levelOf(surface, triangle, texture, &VertexPaint::base, spread));
    }
    switch (material.alpha) {
        case Material::Alpha::Opaque: out.a = 1; break;
        case Material::Alpha::Mask: out.a = out.a >= material.cutoff ? 1.0f : 0.0f; break;
        case Material::Alpha::Blend: break;
    }
    return out;
}

glm::vec3 emissionAt(const Scene& scene, const Surface& surface, size_t triangle, const glm::vec3& barycentrics, float spread) {
    const Material& material = materialOf(scene, surface);
    if (material.emissive == glm::vec3(0) || material.emissiveTexture < 0) return material.emissive;
    const Texture& texture = *scene.textures[size_t(material.emissiveTexture)];
    const VertexPaint paint = paintAt(surface, triangle, barycentrics);
    return material.emissive * glm::vec3(texture.at(paint.emissive, levelOf(surface, triangle, texture, &VertexPaint::emissive, spread)));
}

glm::vec3 meanAlbedo(const Scene& scene, const glm::vec3& plain) {
    if (scene.materials.empty()) return plain;
    glm::dvec3 sum(0);
    double area = 0;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Surface& surface = scene.surfaces[size_t(scene.instances[i].surface)];
        for (size_t t = 0; t < surface.triangles.size(); ++t) {
            const std::array<glm::dvec3, 3> c = cornersOf(scene, int(i), int(t));
            // A triangle is as large as a texel of the mip that is read.
            const auto& corners = surface.triangles[t];
            const glm::vec3 p = surface.positions[corners[0]];
            const float size = std::sqrt(glm::length(glm::cross(surface.positions[corners[1]] - p, surface.positions[corners[2]] - p)));
            const glm::vec4 base = baseColourAt(scene, surface, t, glm::vec3(1 / 3.0f), size);
            const double own = glm::length(glm::cross(c[1] - c[0], c[2] - c[0])) * glm::clamp(double(base.a), 0.0, 1.0);
            if (!(own > 0)) continue;
            sum += own * glm::dvec3(glm::clamp(glm::vec3(base), 0.0f, 1.0f));
            area += own;
        }
    }
    return area > 0 ? glm::vec3(sum / area) : plain;
}

}  // namespace apertura
