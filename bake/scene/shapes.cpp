#include "apertura/bake/scene/shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apertura/bake/sampling/directions.h"

namespace apertura {
namespace {

using glm::dvec3;

// Divides 0 .. length into steps of about `cell`, such that each of `edges` (of holes) is one of the marks.
std::vector<double> marks(double length, double cell, std::vector<double> edges) {
    edges.insert(edges.end(), {0.0, length});
    std::sort(edges.begin(), edges.end());
    std::vector<double> out{0};
    for (size_t i = 0; i + 1 < edges.size(); ++i) {
        const double gap = edges[i + 1] - edges[i];
        if (gap < 1e-9) continue;
        const int steps = std::max(1, int(std::ceil(gap / cell - 1e-9)));
        for (int k = 1; k <= steps; ++k) out.push_back(edges[i] + gap * k / steps);
    }
    return out;
}

double fade(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }

}  // namespace

void addPanel(Surface& surface, const dvec3& corner, const dvec3& u, const dvec3& v, double cell, std::span<const Rect> holes) {
    const double width = glm::length(u), height = glm::length(v);
    std::vector<double> edgesU, edgesV;
    for (const Rect& hole : holes) {
        edgesU.insert(edgesU.end(), {hole.u0, hole.u1});
        edgesV.insert(edgesV.end(), {hole.v0, hole.v1});
    }
    const std::vector<double> us = marks(width, cell, edgesU), vs = marks(height, cell, edgesV);
    const glm::vec3 normal(glm::normalize(glm::cross(u, v)));
    const auto first = uint32_t(surface.positions.size());
    for (double b : vs)
        for (double a : us) {
            surface.positions.emplace_back(corner + u * (a / width) + v * (b / height));
            surface.normals.push_back(normal);
        }
    for (uint32_t j = 0; j + 1 < vs.size(); ++j)
        for (uint32_t i = 0; i + 1 < us.size(); ++i) {
            const double a = (us[i] + us[i + 1]) / 2, b = (vs[j] + vs[j + 1]) / 2;
            if (std::any_of(holes.begin(), holes.end(), [&](const Rect& h) { return a > h.u0 && a < h.u1 && b > h.v0 && b < h.v1; }))
                continue;
            const uint32_t p = first + j * uint32_t(us.size()) + i, q = p + uint32_t(us.size());
            surface.triangles.push_back({p, p + 1, q + 1});
            surface.triangles.push_back({p, q + 1, q});
        }
}

void addPolygon(Surface& surface, std::span<const dvec3> corners) {
    const auto first = uint32_t(surface.positions.size());
    const glm::vec3 normal(glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0])));
    for (const dvec3& corner : corners) {
        surface.positions.emplace_back(corner);
        surface.normals.push_back(normal);
    }
    for (uint32_t k = 1; k + 1 < corners.size(); ++k) surface.triangles.push_back({first, first + k, first + k + 1});
}

void addBox(Surface& surface, const dvec3& low, const dvec3& high, double cell, bool bottom) {
    const dvec3 x(high.x - low.x, 0, 0), y(0, high.y - low.y, 0), z(0, 0, high.z - low.z);
    addPanel(surface, {low.x, low.y, high.z}, x, y, cell);
    addPanel(surface, {high.x, low.y, low.z}, -x, y, cell);
    addPanel(surface, high - y, -z, y, cell);
    addPanel(surface, low, z, y, cell);
    addPanel(surface, {low.x, high.y, high.z}, x, -z, cell);
    if (bottom) addPanel(surface, low, x, z, cell);
}

void addFrustum(Surface& surface, const dvec3& base, double low, double high, double height, int around, int up) {
    const auto first = uint32_t(surface.positions.size());
    const double slope = (low - high) / height;
    for (int i = 0; i <= up; ++i)
        for (int j = 0; j <= around; ++j) {
            const double turn = 2 * std::numbers::pi * j / around, c = std::cos(turn), s = std::sin(turn);
            const double t = double(i) / up, r = low + (high - low) * t;
            surface.positions.emplace_back(base + dvec3(r * c, height * t, r * s));
            surface.normals.emplace_back(glm::normalize(dvec3(c, slope, s)));
        }
    for (int i = 0; i < up; ++i)
        for (int j = 0; j < around; ++j) {
            const uint32_t p = first + uint32_t(i * (around + 1) + j), q = p + uint32_t(around) + 1;
            surface.triangles.push_back({p, q, p + 1});
            surface.triangles.push_back({p + 1, q, q + 1});
        }
}

double noise(const dvec3& p, uint32_t seed) {
    const dvec3 cell = glm::floor(p), f = p - cell;
    const dvec3 w(fade(f.x), fade(f.y), fade(f.z));
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const dvec3 c(corner & 1, corner >> 1 & 1, corner >> 2);
        const auto key = uint64_t(int64_t(cell.x + c.x) & 0x1FFFFF) | uint64_t(int64_t(cell.y + c.y) & 0x1FFFFF) << 21
                       | uint64_t(int64_t(cell.z + c.z) & 0x1FFFFF) << 42;
        const dvec3 g(hashUnit(seed, key, 0) * 2 - 1, hashUnit(seed, key, 1) * 2 - 1, hashUnit(seed, key, 2) * 2 - 1);
        const dvec3 blend = c * w + (1.0 - c) * (1.0 - w);
        sum += blend.x * blend.y * blend.z * glm::dot(g, f - c);
    }
    return sum * 1.5;
}

double fractal(const dvec3& p, int octaves, uint32_t seed) {
    double sum = 0, scale = 1;
    for (int i = 0; i < octaves; ++i, scale *= 2) sum += noise(p * scale, seed + uint32_t(i)) / scale;
    return sum;
}

}  // namespace apertura
