// Meshes of height fields.
#include "apertura/bake/scene/height_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "apertura/bake/sampling/directions.h"
#include "tests/support.h"

namespace apertura::test {
namespace {

HeightField hills(int width, int height) {
    HeightField out{width, height, 10, 14, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            out.heights.push_back(float(40 * std::sin(x * 0.07) * std::cos(y * 0.05) + 6 * std::sin(x * 0.31 + y * 0.4)
                                        + 0.5 * hashUnit(1, uint64_t(x), uint64_t(y))));
    return out;
}

Surface onlyTile(std::vector<Surface> tiles) {
    EXPECT_EQ(tiles.size(), 1u);
    return tiles.at(0);
}

glm::ivec2 texelOf(const Surface& mesh, uint32_t v) { return glm::ivec2(mesh.coordinates[v] * glm::vec2(mesh.grid)); }

// Twice the area of a triangle as seen from above, in cells; above 0 for one that faces up.
int areaOf(const Surface& mesh, const std::array<uint32_t, 3>& t) {
    const glm::ivec2 a = texelOf(mesh, t[0]), b = texelOf(mesh, t[1]), c = texelOf(mesh, t[2]);
    return (b.y - a.y) * (c.x - a.x) - (b.x - a.x) * (c.y - a.y);
}

TEST(HeightMesh, KeepsEveryTexelWithinTheErrorAndNoTriangleOverAnother) {
    for (const auto& [width, height] : {std::pair(129, 129), {257, 129}, {100, 75}, {131, 260}, {2, 2}, {2, 50}}) {
        const HeightField field = hills(width, height);
        size_t last = SIZE_MAX;
        for (const double error : {0.0, 0.5, 2.0, 1000.0}) {
            const Surface mesh = onlyTile(decimatedMesh(field, error));
            EXPECT_LE(mesh.triangles.size(), last) << width << " x " << height << ", " << error;
            last = mesh.triangles.size();
            int64_t area = 0;
            // Of each texel, the height of a triangle that it lies in or on.
            std::vector<double> off(field.texels(), 1e9);
            std::map<std::pair<uint32_t, uint32_t>, int> edges;
            for (const auto& t : mesh.triangles) {
                const int twice = areaOf(mesh, t);
                ASSERT_GT(twice, 0);
                area += twice;
                for (size_t e = 0; e < 3; ++e) ++edges[std::minmax(t[e], t[(e + 1) % 3])];
                const glm::ivec2 a = texelOf(mesh, t[0]), b = texelOf(mesh, t[1]), c = texelOf(mesh, t[2]);
                for (int y = std::min({a.y, b.y, c.y}); y <= std::max({a.y, b.y, c.y}); ++y)
                    for (int x = std::min({a.x, b.x, c.x}); x <= std::max({a.x, b.x, c.x}); ++x) {
                        const glm::ivec2 p(x, y);
                        const auto cross = [](const glm::ivec2& u, const glm::ivec2& v) { return u.y * v.x - u.x * v.y; };
                        const int wa = cross(c - b, p - b), wb = cross(a - c, p - c), wc = cross(b - a, p - a);
                        if (std::min({wa, wb, wc}) < 0) continue;
                        const double at = (double(wa) * mesh.positions[t[0]].y + double(wb) * mesh.positions[t[1]].y
                                           + double(wc) * mesh.positions[t[2]].y)
                                        / twice;
                        const size_t texel = size_t(y) * size_t(width) + size_t(x);
                        off[texel] = std::abs(at - field.heights[texel]);
                    }
            }
            // All of the map is covered, once.
            EXPECT_EQ(area, int64_t(2) * (width - 1) * (height - 1)) << width << " x " << height << ", " << error;
            for (const double o : off) ASSERT_LE(o, error + 1e-4);
            // Each edge within the map has a triangle on either side: there are no gaps.
            for (const auto& [edge, count] : edges) {
                const glm::ivec2 a = texelOf(mesh, edge.first), b = texelOf(mesh, edge.second);
                const bool isBorder = (a.x == b.x && (a.x == 0 || a.x == width - 1)) || (a.y == b.y && (a.y == 0 || a.y == height - 1));
                ASSERT_EQ(count, isBorder ? 1 : 2);
            }
        }
        // Two triangles, where everything is within the error.
        EXPECT_TRUE(width != 129 || height != 129 || last == 2u) << last;
    }
}

TEST(HeightMesh, OfALargeMapIsTilesThatMeet) {
    const HeightField field = hills(kTileTexels + 300, 200);
    const std::vector<Surface> tiles = decimatedMesh(field, 2);
    ASSERT_EQ(tiles.size(), 2u);
    EXPECT_EQ(tiles[0].grid, glm::ivec2(kTileTexels + 1, 200));
    EXPECT_EQ(tiles[1].grid, glm::ivec2(300, 200));
    int64_t area = 0;
    std::vector<glm::vec3> border[2];
    for (size_t i = 0; i < 2; ++i) {
        for (const auto& t : tiles[i].triangles) area += areaOf(tiles[i], t);
        for (size_t v = 0; v < tiles[i].positions.size(); ++v)
            if (texelOf(tiles[i], uint32_t(v)).x == (i == 0 ? kTileTexels : 0)) border[i].push_back(tiles[i].positions[v]);
        std::sort(border[i].begin(), border[i].end(), [](const glm::vec3& p, const glm::vec3& q) { return p.z < q.z; });
    }
    EXPECT_EQ(area, int64_t(2) * (kTileTexels + 299) * 199);
    EXPECT_EQ(border[0], border[1]);
    EXPECT_GT(border[0].size(), 10u);
}

TEST(HeightMesh, HasNoTriangleOverTexelsWithoutData) {
    HeightField field = hills(129, 129);
    for (int y = 40; y < 60; ++y)
        for (int x = 30; x < 90; ++x) field.heights[size_t(y) * 129 + size_t(x)] = std::numeric_limits<float>::quiet_NaN();
    const Surface mesh = onlyTile(decimatedMesh(field, 1e6)), full = fullMesh(field);
    int64_t area = 0, ofAll = 0;
    for (const auto& t : mesh.triangles) area += areaOf(mesh, t);
    for (const auto& t : full.triangles) ofAll += areaOf(full, t);
    // 61 x 21 cells have a corner without data; beside the hole's corners half a cell may be kept.
    EXPECT_NEAR(double(area), 2.0 * (128 * 128 - 61 * 21), 4);
    EXPECT_NEAR(double(ofAll), 2.0 * (128 * 128 - 61 * 21), 4);
    for (const glm::vec3& p : mesh.positions) EXPECT_TRUE(std::isfinite(p.y));
}

TEST(HeightMesh, HasTheNormalsOfAllTexels) {
    const HeightField field = hills(129, 129);
    const Surface mesh = onlyTile(decimatedMesh(field, 3)), full = fullMesh(field);
    ASSERT_EQ(full.positions.size(), field.texels());
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
        const glm::ivec2 at = texelOf(mesh, uint32_t(v));
        const size_t texel = size_t(at.y) * 129 + size_t(at.x);
        EXPECT_EQ(mesh.normals[v], full.normals[texel]);
        EXPECT_EQ(mesh.positions[v], full.positions[texel]);
    }
    // And these are the means of the triangles' normals, scaled to the same height.
    const size_t v = 64 * 129 + 64;
    glm::dvec3 sum(0);
    for (const auto& t : full.triangles)
        if (t[0] == v || t[1] == v || t[2] == v) {
            const glm::dvec3 n = glm::cross(glm::dvec3(full.positions[t[1]] - full.positions[t[0]]),
                                            glm::dvec3(full.positions[t[2]] - full.positions[t[0]]));
            sum += n / n.y;
        }
    EXPECT_LT(glm::distance(glm::vec3(glm::normalize(sum)), full.normals[v]), 1e-5f);
}

}  // namespace
}  // namespace apertura::test
