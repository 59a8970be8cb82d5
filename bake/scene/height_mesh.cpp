#include "apertura/bake/scene/height_mesh.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>

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

void addVertex(const HeightField& field, int x, int y, const glm::vec2& slope, Surface& out) {
    const float height = field.heights[size_t(y) * size_t(field.width) + size_t(x)];
    out.positions.emplace_back(placeOf(field, x, y, height));
    out.normals.push_back(glm::normalize(glm::vec3(-slope.x, 1, -slope.y)));
    out.coordinates.emplace_back((float(x) + 0.5f) / float(field.width), (float(y) + 0.5f) / float(field.height));
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
                addVertex(field, x, y, slopes[at(x, y)], out);
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

Surface decimatedMesh(const HeightField& field, double error, const Progress& progress) {
    const std::vector<glm::vec2> slopes = slopesOf(field);
    const Decimation decimation(field, error, progress);
    Surface out;
    std::vector<uint32_t> vertex(field.texels(), UINT32_MAX);
    const auto numberOf = [&](const Corner& p) {
        const size_t texel = size_t(p.y) * size_t(field.width) + size_t(p.x);
        if (vertex[texel] == UINT32_MAX) {
            vertex[texel] = uint32_t(out.positions.size());
            addVertex(field, p.x, p.y, slopes[texel], out);
        }
        return vertex[texel];
    };
    for (int y = 0; y * kLargest + 1 < field.height; ++y)
        for (int x = 0; x * kLargest + 1 < field.width; ++x)
            decimation.triangles(x, y, [&](const Triangle& t) { out.triangles.push_back({numberOf(t.a), numberOf(t.b), numberOf(t.c)}); });
    out.grid = {field.width, field.height};
    return out;
}

MeshError errorOf(const HeightField& field, const Surface& mesh) {
    MeshError out;
    std::mutex mutex;
    double squares = 0, count = 0;
    const auto texelOf = [&](uint32_t v) { return mesh.coordinates[v] * glm::vec2(mesh.grid) - 0.5f; };
    tbb::parallel_for(tbb::blocked_range<size_t>(0, mesh.triangles.size(), 4096), [&](const tbb::blocked_range<size_t>& range) {
        double mostHere = 0, squaresHere = 0, countHere = 0;
        for (size_t k = range.begin(); k < range.end(); ++k) {
            const auto& t = mesh.triangles[k];
            const glm::dvec2 a = glm::round(texelOf(t[0])), b = glm::round(texelOf(t[1])), c = glm::round(texelOf(t[2]));
            const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
            if (area == 0) continue;
            for (int y = int(std::min({a.y, b.y, c.y})); y <= int(std::max({a.y, b.y, c.y})); ++y)
                for (int x = int(std::min({a.x, b.x, c.x})); x <= int(std::max({a.x, b.x, c.x})); ++x) {
                    const double wb = ((x - a.x) * (c.y - a.y) - (y - a.y) * (c.x - a.x)) / area,
                                 wc = ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)) / area;
                    if (std::min({wb, wc, 1 - wb - wc}) < 0) continue;
                    const double height = (1 - wb - wc) * mesh.positions[t[0]].y + wb * mesh.positions[t[1]].y
                                        + wc * mesh.positions[t[2]].y;
                    const double off = std::abs(height - field.heights[size_t(y) * size_t(field.width) + size_t(x)]);
                    mostHere = std::max(mostHere, off), squaresHere += off * off, ++countHere;
                }
        }
        const std::lock_guard lock(mutex);
        out.most = std::max(out.most, mostHere), squares += squaresHere, count += countHere;
    });
    out.rms = std::sqrt(squares / std::max(count, 1.0));
    return out;
}

}  // namespace apertura
