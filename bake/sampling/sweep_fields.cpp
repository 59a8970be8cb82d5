#include "apertura/bake/sampling/sweep_fields.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "apertura/bake/sampling/horizons.h"
#include "apertura/bake/sampling/lanes.h"

namespace apertura {
namespace {

constexpr int kTile = 32;            // texels a side of a transposed block
constexpr double kOnLattice = 1e-6;  // of a texel: what an edge is crossed beside its end is its end
constexpr double kStraight = 1e-9;   // a shift that is none, or a whole one

// to[b][a] = from[a][b], `to` and `from` with rows that are `stride` numbers apart, in blocks that fit into the nearest cache.
void turn(const float* from, size_t stride, int rows, int columns, float* to, size_t toStride) {
    tbb::parallel_for(0, (rows + kTile - 1) / kTile, [&](int tile) {
        const int end = std::min(rows, (tile + 1) * kTile);
        for (int first = 0; first < columns; first += kTile)
            for (int b = first; b < std::min(columns, first + kTile); ++b)
                for (int a = tile * kTile; a < end; ++a) to[size_t(b) * toStride + size_t(a)] = from[size_t(a) * stride + size_t(b)];
    });
}

void setSize(SweepField& to, int along, int across) {
    to.along = along, to.across = across;
    to.stride = (size_t(across) + 2 * SweepField::kBeside + kLanes - 1) / kLanes * kLanes;
}

void setHeights(SweepField& rows, const HeightField& field) {
    setSize(rows, field.height, field.width);
    rows.heights.assign(rows.size(), SweepField::kNone);
    tbb::parallel_for(0, field.height, [&](int y) {
        const float* from = &field.heights[size_t(y) * size_t(field.width)];
        float* to = &rows.heights[rows.at(y, 0)];
        for (int x = 0; x < field.width; ++x) to[x] = std::isnan(from[x]) ? SweepField::kNone : from[x];
    });
}

// Sets slopes to the south and to the east (slopesOf says which).
void setSlopes(SweepField& rows, const HeightField& field) {
    for (std::vector<float>& slopes : rows.slopes) slopes.resize(rows.size());
    const auto perEast = float(1 / field.spacingX), perSouth = float(1 / field.spacingZ);
    const auto stride = std::ptrdiff_t(rows.stride);
    tbb::parallel_for(0, field.height, [&](int y) {
        const float* at = &rows.heights[rows.at(y, 0)];
        float *south = &rows.slopes[0][rows.at(y, 0)], *east = &rows.slopes[1][rows.at(y, 0)];
        for (int x = 0; x < rows.across; ++x) {
            const float o = at[x], e = at[x + 1], w = at[x - 1], n = at[x - stride], s = at[x + stride], ne = at[x + 1 - stride],
                        sw = at[x - 1 + stride];
            float risesEast = 0, risesSouth = 0, count = 0;
            // Of a triangle: its rise to the east, to the south, and the lowest of its corners.
            const auto add = [&](float eastwards, float southwards, float lowest) {
                const bool there = lowest > SweepField::kNone / 2;
                risesEast += there ? eastwards : 0, risesSouth += there ? southwards : 0, count += there ? 1.0f : 0.0f;
            };
            const auto least = [](float a, float b, float c) {
                const float d = a < b ? a : b;
                return c < d ? c : d;
            };
            add(e - o, s - o, least(o, e, s));
            add(e - o, e - ne, least(o, e, ne));
            add(ne - n, o - n, least(o, n, ne));
            add(o - w, o - n, least(o, w, n));
            add(o - w, sw - w, least(o, w, sw));
            add(s - sw, s - o, least(o, s, sw));
            const float scale = count > 0 ? 1 / count : 0;
            east[x] = risesEast * scale * perEast;
            south[x] = risesSouth * scale * perSouth;
        }
    });
}

}  // namespace

SweepFields::SweepFields(const HeightField& field, bool sums) {
    setHeights(rows, field);
    setSize(columns, field.width, field.height);
    columns.heights.assign(columns.size(), SweepField::kNone);
    const auto turnInto = [&](std::vector<float>& ofColumns, const std::vector<float>& ofRows) {
        turn(&ofRows[rows.at(0, 0)], rows.stride, rows.along, rows.across, &ofColumns[columns.at(0, 0)], columns.stride);
    };
    turnInto(columns.heights, rows.heights);
    if (!sums) return;
    for (SweepField* to : {&rows, &columns})
        for (std::vector<float>* of : {&to->area, &to->vertical, &to->horizontal[0], &to->horizontal[1]}) of->resize(to->size());
    setSlopes(rows, field);
    for (size_t axis = 0; axis < 2; ++axis) {
        columns.slopes[axis].resize(columns.size());
        turnInto(columns.slopes[axis], rows.slopes[1 - axis]);
    }
}

std::vector<glm::vec2> slopesOf(const HeightField& field) {
    SweepField rows;
    setHeights(rows, field);
    setSlopes(rows, field);
    std::vector<glm::vec2> out(field.texels());
    tbb::parallel_for(0, field.height, [&](int y) {
        for (int x = 0; x < field.width; ++x)
            out[size_t(y) * size_t(field.width) + size_t(x)] = {rows.slopes[1][rows.at(y, x)], rows.slopes[0][rows.at(y, x)]};
    });
    return out;
}

void SweepFields::turnBack(const std::vector<float>& ofColumns, std::vector<float>& out) const {
    out.resize(size_t(rows.along) * size_t(rows.across));
    turn(&ofColumns[columns.at(0, 0)], columns.stride, columns.along, columns.across, out.data(), size_t(rows.across));
}

SweepCourse courseOf(const HeightField& of, double azimuth, double curvature) {
    // Texels a metre.
    const double east = std::sin(azimuth) / of.spacingX, south = -std::cos(azimuth) / of.spacingZ;
    const bool columns = std::abs(east) > std::abs(south);
    const double along = columns ? east : south, across = columns ? south : east;
    SweepCourse out{columns, along < 0, {}, 1 / std::abs(along)};
    SweepDirection& d = out.direction;
    const double sign = along < 0 ? -1 : 1;
    d.unit[0] = float(sign * (columns ? std::sin(azimuth) : -std::cos(azimuth)));
    d.unit[1] = float(sign * (columns ? -std::cos(azimuth) : std::sin(azimuth)));
    d.shift = across / along;
    if (std::abs(d.shift) < kStraight) d.shift = 0;
    if (std::abs(std::abs(d.shift) - 1) < kStraight) d.shift = d.shift < 0 ? -1 : 1;
    d.step = float(out.step);
    d.curvature = float(curvature);
    return out;
}

std::vector<SweepCrossing> crossingsOf(size_t stride, const glm::dvec2& perStep, double step, double curvature, int reach) {
    std::vector<SweepCrossing> out;
    const auto offset = [&](const glm::ivec2& p) { return std::ptrdiff_t(p.y) * std::ptrdiff_t(stride) + p.x; };
    // After `steps`, at a point of the edge between two texels of which the second has the weight.
    const auto add = [&](double steps, const glm::ivec2& from, const glm::ivec2& to, double weight) {
        const bool atFrom = weight<kOnLattice, atTo = weight> 1 - kOnLattice;
        const double metres = steps * step;
        out.push_back({offset(atTo ? to : from), offset(atFrom ? from : to),
                       atFrom ? 0
                       : atTo ? 1
                              : float(weight),
                       float(1 / metres), float(curvature * metres * metres)});
    };
    // Columns and rows of texels.
    for (int axis = 0; axis < 2; ++axis) {
        const double rate = std::abs(perStep[axis]);
        for (int k = 1; rate > kOnLattice && k / rate <= reach + kOnLattice; ++k) {
            const double steps = k / rate, beside = steps * perStep[1 - axis], low = std::floor(beside + kOnLattice);
            glm::ivec2 from;
            from[axis] = perStep[axis] > 0 ? k : -k, from[1 - axis] = int(low);
            glm::ivec2 to = from;
            ++to[1 - axis];
            add(steps, from, to, std::max(beside - low, 0.0));
        }
    }
    // The diagonals join (x + 1, y) and (x, y + 1): x + y is whole along them.
    const double rate = std::abs(perStep.x + perStep.y);
    for (int k = 1; rate > kOnLattice && k / rate <= reach + kOnLattice; ++k) {
        const double steps = k / rate, x = steps * perStep.x, low = std::floor(x + kOnLattice), weight = std::max(x - low, 0.0);
        if (weight < kOnLattice) continue;  // a texel, which is crossed above
        const int left = int(low), sum = perStep.x + perStep.y > 0 ? k : -k;
        add(steps, {left, sum - left}, {left + 1, sum - left - 1}, weight);
    }
    return out;
}

SweepField rowsOf(const HeightField& field) {
    SweepField out;
    setHeights(out, field);
    return out;
}

}  // namespace apertura
