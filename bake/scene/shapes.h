#pragma once
// Tessellated shapes and noise for the built-in scenes. Lengths in metres, +Y up, normals outwards. The add functions
// append to a surface.
#include <numbers>
#include <span>

#include "apertura/runtime/asset/scene.h"

namespace apertura {

struct Rect {
    double u0, v0, u1, v1;
};

// Adds a parallelogram with its normal along cross(u, v).
//   corner, u, v  one corner and the two edges from it, metres
//   cell          size of the quads, about, metres
//   holes         openings, metres along u and v; mesh edges follow their outlines
void addPanel(Surface& surface, const glm::dvec3& corner, const glm::dvec3& u, const glm::dvec3& v, double cell,
              std::span<const Rect> holes = {});

// Adds a convex, flat polygon as a fan of triangles. `corners`: 3 or more, counter-clockwise, metres.
void addPolygon(Surface& surface, std::span<const glm::dvec3> corners);
inline void addPolygon(Surface& surface, std::initializer_list<glm::dvec3> corners) {
    addPolygon(surface, std::span(corners.begin(), corners.size()));
}

// Adds an axis-aligned box in quads of about `cell` metres; without its bottom if `bottom` is false.
void addBox(Surface& surface, const glm::dvec3& low, const glm::dvec3& high, double cell, bool bottom = true);

// Adds a frustum about the vertical, without caps.
//   low, high   radii at `base` and at base.y + height, metres
//   around, up  number of quads about the axis and along it
void addFrustum(Surface& surface, const glm::dvec3& base, double low, double high, double height, int around, int up);

// Adds a closed surface that is star-shaped about `centre`; its normals are makeNormals'.
//   around  number of quads about the vertical; half as many from pole to pole
//   radius  function: metres from the centre along a unit direction; a constant gives a sphere
template <typename Radius>
void addBlob(Surface& surface, const glm::dvec3& centre, int around, Radius&& radius);

// Gradient noise over the unit lattice, about -1..1; and a sum of `octaves` of it, each with half the amplitude and twice
// the frequency of the one before. After Perlin, "Improving noise", 2002, with hashed gradients.
double noise(const glm::dvec3& p, uint32_t seed);
double fractal(const glm::dvec3& p, int octaves, uint32_t seed);

template <typename Radius>
void addBlob(Surface& surface, const glm::dvec3& centre, int around, Radius&& radius) {
    using std::numbers::pi;
    const int down = around / 2;
    const auto first = uint32_t(surface.positions.size());
    Surface blob;
    // The poles are one vertex each, and the seam is closed.
    auto add = [&](double theta, double phi) {
        const glm::dvec3 w(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
        blob.positions.emplace_back(centre + radius(w) * w);
    };
    add(0, 0);
    for (int i = 1; i < down; ++i)
        for (int j = 0; j < around; ++j) add(pi * i / down, 2 * pi * j / around);
    add(pi, 0);
    auto at = [&](int i, int j) {
        return i == 0 ? 0u : i == down ? uint32_t(blob.positions.size() - 1) : uint32_t(1 + (i - 1) * around + j % around);
    };
    for (int i = 0; i < down; ++i)
        for (int j = 0; j < around; ++j) {
            if (i > 0) blob.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j)});
            if (i + 1 < down) blob.triangles.push_back({at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)});
        }
    makeNormals(blob);
    surface.positions.insert(surface.positions.end(), blob.positions.begin(), blob.positions.end());
    surface.normals.insert(surface.normals.end(), blob.normals.begin(), blob.normals.end());
    for (const auto& t : blob.triangles) surface.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

}  // namespace apertura
