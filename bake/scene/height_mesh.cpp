#include "apertura/bake/scene/height_mesh.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "apertura/bake/sampling/horizons.h"

namespace apertura {
namespace {

constexpr int kLargest = 128;  // texels along the legs of the largest triangle, a power of two
constexpr float kAlways = std::numeric_limits<float>::infinity();

using Corner = glm::ivec2;  // a texel, or a place outside of the field

struct Triangle {
    Corner a, b, c;  // the longest side, from a to b; c the right angle
};

Corner between(const Corner& a, const Corner& b) { return (a + b) / 2; }
bool isWhole(const Triangle& t) { return ((t.a.x + t.b.x) | (t.a.y + t.b.y)) % 2 == 0; }  // false: half a texel's cell

class Decimation {
public:
    Decimation(const HeightField& field, double error, const Progress& progress) : field_(field), most_(float(error)) {
        errors_.assign(field.texels(), 0);
        // From the finest triangles to the coarsest: a texel splits its triangles if these err, or if a finer split needs its own.
        for (int side = 2, step = 0; side <= kLargest; side *= 2, ++step) {
            judgeSides(side);
            judgeMiddles(side);
            throwIfStopped(progress, double(step + 1) / std::log2(kLargest));
        }
    }

    // Calls use(triangle) for the triangles that are left within a square of kLargest texels, of those whose corners all have data.
    void triangles(int squareX, int squareY, const auto& use) const {
        for (const Triangle& t : halvesOf(squareX * kLargest, squareY * kLargest, kLargest)) split(t, use);
    }

private:
    bool isInside(const Corner& p) const { return p.x >= 0 && p.y >= 0 && p.x < field_.width && p.y < field_.height; }
    float heightAt(const Corner& p) const {
        return isInside(p) ? field_.heights[size_t(p.y) * size_t(field_.width) + size_t(p.x)] : std::numeric_limits<float>::quiet_NaN();
    }
    float& errorAt(const Corner& p) { return errors_[size_t(p.y) * size_t(field_.width) + size_t(p.x)]; }
    // Of a texel outside, which only triangles that lie partly outside have: these are always split.
    float splitError(const Corner& p) const { return isInside(p) ? errors_[size_t(p.y) * size_t(field_.width) + size_t(p.x)] : kAlways; }

    // A square of the lattice of `side` is halved by the diagonal between the corners of which both or none of the coordinates are even
    // multiples of the side.
    static std::array<Triangle, 2> halvesOf(int x, int y, int side) {
        const Corner nw{x, y}, ne{x + side, y}, sw{x, y + side}, se{x + side, y + side};
        if ((x / side + y / side) % 2 == 0) return {Triangle{nw, se, ne}, Triangle{se, nw, sw}};
        return {Triangle{ne, sw, se}, Triangle{sw, ne, nw}};
    }

    // The largest distance, up or down, between the texels of a triangle and its plane: kAlways where one of them has no data.
    float errorOf(const Triangle& t) const {
        const float ha = heightAt(t.a), hb = heightAt(t.b), hc = heightAt(t.c);
        const float doubleArea = float((t.b.x - t.a.x) * (t.c.y - t.a.y) - (t.b.y - t.a.y) * (t.c.x - t.a.x));
        const float slopeX = ((hb - ha) * float(t.c.y - t.a.y) - (hc - ha) * float(t.b.y - t.a.y)) / doubleArea;
        const float slopeY = ((hc - ha) * float(t.b.x - t.a.x) - (hb - ha) * float(t.c.x - t.a.x)) / doubleArea;
        if (std::isnan(slopeX + slopeY)) return kAlways;
        const auto [top, bottom] = std::minmax({t.a.y, t.b.y, t.c.y});
        float error = 0;
        bool complete = true;
        for (int y = top; y <= bottom; ++y) {
            // Where the row enters and leaves the triangle, whose sides lie along texels or at 45 degrees.
            int left = std::numeric_limits<int>::max(), right = std::numeric_limits<int>::min();
            for (const auto& [p, q] : {std::pair(t.a, t.b), {t.b, t.c}, {t.c, t.a}}) {
                if (y < std::min(p.y, q.y) || y > std::max(p.y, q.y)) continue;
                const int x0 = p.y == q.y ? std::min(p.x, q.x) : p.x + (q.x - p.x) * (y - p.y) / (q.y - p.y);
                const int x1 = p.y == q.y ? std::max(p.x, q.x) : x0;
                left = std::min(left, x0), right = std::max(right, x1);
            }
            const float* row = &field_.heights[size_t(y) * size_t(field_.width)];
            const float start = ha + slopeY * float(y - t.a.y);
            for (int x = left; x <= right; ++x) {
                const float off = std::abs(row[x] - start - slopeX * float(x - t.a.x));
                complete &= off <= kAlways;
                error = off > error ? off : error;
            }
        }
        return complete ? error : kAlways;
    }

    // Texels in the middle of the sides of the lattice's squares: each parts two triangles whose right angles are the squares' middles.
    void judgeSides(int side) {
        const int half = side / 2;
        tbb::parallel_for(0, field_.height / half + 1, [&](int row) {
            const int y = row * half;
            if (y >= field_.height) return;
            for (int x = row % 2 ? 0 : half; x < field_.width; x += side) {
                const Corner m{x, y}, along = row % 2 ? Corner(0, half) : Corner(half, 0), across(along.y, along.x);
                float error = 0;
                for (const Corner& apex : {m - across, m + across})
                    if (isInside(apex) || touches(apex, side)) error = std::max(error, errorOf({m - along, m + along, apex}));
                if (side > 2)
                    for (const Corner& finer :
                         {Corner(half / 2, half / 2), {-half / 2, half / 2}, {half / 2, -half / 2}, {-half / 2, -half / 2}})
                        if (isInside(m + finer)) error = std::max(error, errorAt(m + finer));
                errorAt(m) = error;
            }
        });
    }

    // A place outside of the field in whose square some of the field lies.
    bool touches(const Corner& middle, int side) const {
        return middle.x - side / 2 < field_.width - 1 && middle.y - side / 2 < field_.height - 1 && middle.x > 0 && middle.y > 0;
    }

    // Texels in the middle of the squares, which part their halves.
    void judgeMiddles(int side) {
        const int half = side / 2;
        tbb::parallel_for(0, field_.height / side + 1, [&](int row) {
            const int y = row * side + half;
            if (y >= field_.height) return;
            for (int x = half; x < field_.width; x += side) {
                const Corner m{x, y};
                float error = 0;
                for (const Triangle& t : halvesOf(x - half, y - half, side)) error = std::max(error, errorOf(t));
                for (const Corner& finer : {Corner(half, 0), {-half, 0}, {0, half}, {0, -half}})
                    if (isInside(m + finer)) error = std::max(error, errorAt(m + finer));
                errorAt(m) = error;
            }
        });
    }

    void split(const Triangle& t, const auto& use) const {
        if (isWhole(t)) {
            const Corner m = between(t.a, t.b);
            if (splitError(m) > most_) {
                split({t.c, t.a, m}, use);
                split({t.b, t.c, m}, use);
                return;
            }
        }
        if (!std::isnan(heightAt(t.a) + heightAt(t.b) + heightAt(t.c))) use(t);
    }

    const HeightField& field_;
    float most_;                 // metres
    std::vector<float> errors_;  // of each texel: the largest error of the triangles that it parts, and of all finer ones that need it
};

// A part of a field: its first texel, and how many.
struct Tile {
    int left, top, width, height;
};

void addVertex(const HeightField& field, const Tile& tile, const Corner& p, const glm::vec2& slope, Surface& out) {
    const float height = field.heights[size_t(p.y) * size_t(field.width) + size_t(p.x)];
    out.positions.emplace_back(placeOf(field, p.x, p.y, height));
    out.normals.push_back(glm::normalize(glm::vec3(-slope.x, 1, -slope.y)));
    out.coordinates.emplace_back((float(p.x - tile.left) + 0.5f) / float(tile.width), (float(p.y - tile.top) + 0.5f) / float(tile.height));
}

}  // namespace

glm::dvec3 placeOf(const HeightField& field, int x, int y, float height) {
    return {(x - 0.5 * (field.width - 1)) * field.spacingX, height, (y - 0.5 * (field.height - 1)) * field.spacingZ};
}

Surface fullMesh(const HeightField& field) {
    Surface out;
    const std::vector<glm::vec2> slopes = slopesOf(field);
    std::vector<uint32_t> vertex(field.texels(), UINT32_MAX);
    const auto at = [&](int x, int y) { return size_t(y) * size_t(field.width) + size_t(x); };
    for (int y = 0; y < field.height; ++y)
        for (int x = 0; x < field.width; ++x)
            if (!std::isnan(field.heights[at(x, y)])) {
                vertex[at(x, y)] = uint32_t(out.positions.size());
                addVertex(field, {0, 0, field.width, field.height}, {x, y}, slopes[at(x, y)], out);
            }
    for (int y = 0; y + 1 < field.height; ++y)
        for (int x = 0; x + 1 < field.width; ++x) {
            const uint32_t a = vertex[at(x, y)], b = vertex[at(x + 1, y)], c = vertex[at(x, y + 1)], d = vertex[at(x + 1, y + 1)];
            if (a != UINT32_MAX && b != UINT32_MAX && c != UINT32_MAX) out.triangles.push_back({a, c, b});
            if (b != UINT32_MAX && c != UINT32_MAX && d != UINT32_MAX) out.triangles.push_back({b, c, d});
        }
    out.grid = {field.width, field.height};
    return out;
}

std::vector<Surface> decimatedMesh(const HeightField& field, double error, const Progress& progress) {
    const std::vector<glm::vec2> slopes = slopesOf(field);
    const Decimation decimation(field, error, progress);
    std::vector<Surface> out;
    std::vector<uint32_t> vertex(field.texels(), UINT32_MAX);
    constexpr int squares = kTileTexels / kLargest;
    for (int top = 0; top + 1 < field.height; top += kTileTexels)
        for (int left = 0; left + 1 < field.width; left += kTileTexels) {
            const Tile tile{left, top, std::min(kTileTexels + 1, field.width - left), std::min(kTileTexels + 1, field.height - top)};
            // What it shares with tiles before has their numbers.
            for (int y = top; y < top + tile.height; ++y) {
                const auto row = vertex.begin() + std::ptrdiff_t(y) * field.width + left;
                std::fill(row, row + tile.width, UINT32_MAX);
            }
            Surface surface;
            const auto numberOf = [&](const Corner& p) {
                const size_t texel = size_t(p.y) * size_t(field.width) + size_t(p.x);
                if (vertex[texel] == UINT32_MAX) {
                    vertex[texel] = uint32_t(surface.positions.size());
                    addVertex(field, tile, p, slopes[texel], surface);
                }
                return vertex[texel];
            };
            for (int y = top / kLargest; y < top / kLargest + squares && y * kLargest + 1 < field.height; ++y)
                for (int x = left / kLargest; x < left / kLargest + squares && x * kLargest + 1 < field.width; ++x)
                    decimation.triangles(x, y, [&](const Triangle& t) {
                        surface.triangles.push_back({numberOf(t.a), numberOf(t.b), numberOf(t.c)});
                    });
            if (surface.triangles.empty()) continue;
            surface.grid = {tile.width, tile.height};
            out.push_back(std::move(surface));
        }
    return out;
}

}  // namespace apertura
