#include "apertura/bake/sampling/horizons.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/sampling/horizon_exact.h"
#include "apertura/bake/sampling/horizon_sweep.h"
#include "apertura/bake/sampling/lanes.h"
#include "apertura/bake/sampling/sweep_fields.h"

namespace apertura {
namespace {

using std::numbers::pi;

constexpr int kGroupsATask = 2;  // of lines
constexpr int kFewestAzimuths = 8;
constexpr double kSameAzimuth = 1e-9;                 // radians
constexpr int kTrueTexels = 128, kTrueAzimuths = 64;  // where and by which sums over azimuths are judged

void sweep(SweepFields& fields, SweepCourse course, const SweepHorizons& keep) {
    SweepField& field = course.columns ? fields.columns : fields.rows;
    for (int way = 0; way < 2; ++way)
        course.direction.crossings[way] = crossingsOf(field.stride, course.perStep(way), course.step, course.direction.curvature, kNear);
    const int groups = sweepGroups(field, course.direction);
    tbb::parallel_for(tbb::blocked_range<int>(0, groups, kGroupsATask),
                      [&](const tbb::blocked_range<int>& range) { sweepLines(field, course.direction, range.begin(), range.end(), keep); });
}

// Texels to the east and to the south, a metre towards an azimuth.
glm::dvec2 perMetre(const HeightField& field, double azimuth) {
    return {std::sin(azimuth) / field.spacingX, -std::cos(azimuth) / field.spacingZ};
}

// What a texel sees by exact horizons.
struct TexelTruth {
    int x, y;
    float area;
    glm::vec3 direction;
};

std::vector<TexelTruth> truthOf(const HeightField& field, const SweepFields& fields, double curvature) {
    std::vector<TexelTruth> out;
    const auto add = [&](size_t texel) {
        if (!std::isnan(field.heights[texel]))
            out.push_back({int(texel % size_t(field.width)), int(texel / size_t(field.width)), 0, glm::vec3(0)});
    };
    for (uint64_t i = 0; out.size() < kTrueTexels && i < 10 * kTrueTexels; ++i) add(size_t(hashUnit(1, i, 0) * double(field.texels())));
    // Where few have data, those.
    for (size_t texel = 0; out.size() < kTrueTexels && texel < field.texels(); ++texel) add(texel);
    const HighestHeights highest(fields.rows);
    std::vector<std::vector<float>> tangents(kTrueAzimuths, std::vector<float>(out.size()));
    tbb::parallel_for(0, kTrueAzimuths, [&](int k) {
        const ExactCourse exact(fields.rows, highest, perMetre(field, 2 * pi * k / kTrueAzimuths), curvature, 0);
        for (size_t i = 0; i < out.size(); ++i) {
            float all[kLanes];
            exactTangents(exact, out[i].y, out[i].y + 1, out[i].x, all, kLanes);
            tangents[size_t(k)][i] = all[0];
        }
    });
    for (size_t i = 0; i < out.size(); ++i) {
        const glm::vec2 slope = fields.slopeAt(out[i].x, out[i].y);
        glm::dvec4 sum(0);
        for (int k = 0; k < kTrueAzimuths; ++k) {
            const double azimuth = 2 * pi * k / kTrueAzimuths, east = std::sin(azimuth), south = -std::cos(azimuth);
            const double h = std::atan(std::max(double(tangents[size_t(k)][i]), east * slope.x + south * slope.y));
            const double along = (pi / 2 - h) / 2 - std::sin(2 * h) / 4;
            sum += glm::dvec4(along * east, std::cos(h) * std::cos(h) / 2, along * south, 1 - std::sin(h));
        }
        sum *= 2 * pi / kTrueAzimuths;
        out[i].area = float(sum.w), out[i].direction = glm::vec3(sum);
    }
    return out;
}

double angleBetween(const glm::vec3& a, const glm::vec3& b) {
    const double length = double(glm::length(a)) * double(glm::length(b));
    return length > 0 ? std::acos(std::clamp(double(glm::dot(a, b)) / length, -1.0, 1.0)) : 0;
}

std::optional<tbb::global_control> limitTo(int threads) {
    std::optional<tbb::global_control> limit;
    if (threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, size_t(threads));
    return limit;
}

}  // namespace

OpenSky openSky(const HeightField& field, double error, const HorizonOptions& options, const Progress& progress) {
    const auto limit = limitTo(options.threads);
    SweepFields fields(field, true);
    const std::vector<TexelTruth> truth = truthOf(field, fields, options.curvature);
    OpenSky out;
    for (int azimuths = kFewestAzimuths; azimuths <= kMostAzimuths; azimuths *= 2) {
        const bool first = azimuths == kFewestAzimuths;
        for (int k = first ? 0 : 1; k < azimuths / 2; k += first ? 1 : 2) {
            sweep(fields, courseOf(field, 2 * pi * k / azimuths, options.curvature), {});
            const int done = first ? 2 * k : azimuths / 2 + k;
            throwIfStopped(progress, double(done) / kMostAzimuths);
        }
        out.azimuths = azimuths;
        double areas = 0, angles = 0;
        for (const TexelTruth& t : truth) {
            const glm::vec4 found = fields.sumAt(t.x, t.y) * float(2 * pi / azimuths);
            areas += std::pow((found.w - t.area) / (2 * pi), 2);
            angles += std::pow(angleBetween(glm::vec3(found), t.direction), 2);
        }
        out.areaError = std::sqrt(areas / double(truth.size()));
        out.directionError = std::sqrt(angles / double(truth.size())) * 180 / pi;
        if (out.areaError <= error) break;
    }
    const auto scale = float(2 * pi / out.azimuths);
    const SweepField &r = fields.rows, &c = fields.columns;
    out.area.resize(field.texels());
    out.direction.resize(field.texels());
    std::vector<float> ofColumns;
    const auto take = [&](const std::vector<float>& rows, const std::vector<float>& columns, const auto& to) {
        fields.turnBack(columns, ofColumns);
        tbb::parallel_for(0, field.height, [&](int y) {
            const size_t row = size_t(y) * size_t(field.width);
            const float* ofRows = &rows[r.at(y, 0)];
            for (int x = 0; x < field.width; ++x) to(row + size_t(x)) = scale * (ofRows[x] + ofColumns[row + size_t(x)]);
        });
    };
    take(r.area, c.area, [&](size_t texel) -> float& { return out.area[texel]; });
    take(r.horizontal[1], c.horizontal[0], [&](size_t texel) -> float& { return out.direction[texel].x; });
    take(r.vertical, c.vertical, [&](size_t texel) -> float& { return out.direction[texel].y; });
    take(r.horizontal[0], c.horizontal[1], [&](size_t texel) -> float& { return out.direction[texel].z; });
    return out;
}

namespace {

// The rows from `row` on of what was found, and -infinity where there is nothing.
void keepRows(const SweepField& rows, int row, int count, const float* from, size_t stride, std::vector<float>& out) {
    tbb::parallel_for(0, count, [&](int i) {
        const float *line = from + size_t(i) * stride, *heights = &rows.heights[rows.at(row + i, 0)];
        float* to = &out[size_t(i) * size_t(rows.across)];
        for (int x = 0; x < rows.across; ++x)
            to[x] = line[x] > kNoHorizon && heights[x] > SweepField::kNone / 2 ? line[x] : -std::numeric_limits<float>::infinity();
    });
}

void findExactly(const HeightField& field, std::span<const double> azimuths, const HorizonOptions& options,
                 const std::function<void(size_t, int, std::span<const float>)>& use, const Progress& progress) {
    const SweepField rows = rowsOf(field);
    const HighestHeights highest(rows);
    const int band = options.band > 0 ? std::min(options.band, field.height) : field.height;
    const int strips = (field.width + kLanes - 1) / kLanes;
    const size_t stride = size_t(strips) * kLanes;
    std::vector<float> tangents(size_t(band) * stride), out;
    for (int row = 0; row < field.height; row += band) {
        const int end = std::min(row + band, field.height);
        out.resize(size_t(end - row) * size_t(field.width));
        for (size_t k = 0; k < azimuths.size(); ++k) {
            const ExactCourse course(rows, highest, perMetre(field, azimuths[k]), options.curvature, options.farthest);
            tbb::parallel_for(0, strips,
                              [&](int s) { exactTangents(course, row, end, s * kLanes, &tangents[size_t(s) * kLanes], stride); });
            keepRows(rows, row, end - row, tangents.data(), stride, out);
            use(k, row, out);
            throwIfStopped(progress, (double(row) + double(end - row) * double(k + 1) / double(azimuths.size())) / field.height);
        }
    }
}

}  // namespace

void findHorizons(const HeightField& field, std::span<const double> azimuths, const HorizonOptions& options,
                  const std::function<void(size_t, int, std::span<const float>)>& use, const Progress& progress) {
    const auto limit = limitTo(options.threads);
    if (options.isExact) return findExactly(field, azimuths, options, use, progress);
    SweepFields fields(field, false);
    std::vector<float> tangents[2], rows(field.texels());
    for (std::vector<float>& t : tangents) t.resize(std::max(fields.rows.size(), fields.columns.size()));
    std::vector<bool> isDone(azimuths.size(), false);
    for (size_t k = 0; k < azimuths.size(); ++k) {
        if (isDone[k]) continue;
        const SweepCourse course = courseOf(field, azimuths[k], options.curvature);
        // Which of the azimuths lies forwards along the course, and which backwards.
        size_t opposite = k + 1;
        while (opposite < azimuths.size() && std::abs(std::remainder(azimuths[opposite] - azimuths[k] - pi, 2 * pi)) > kSameAzimuth)
            ++opposite;
        size_t wayOf[2] = {k, opposite};
        if (course.backwards) std::swap(wayOf[0], wayOf[1]);
        sweep(fields, course, {{tangents[0].data(), tangents[1].data()}});
        for (size_t way = 0; way < 2; ++way) {
            if (wayOf[way] == azimuths.size()) continue;
            if (course.columns) fields.turnBack(tangents[way], rows);
            const float* const from = course.columns ? rows.data() : &tangents[way][fields.rows.at(0, 0)];
            keepRows(fields.rows, 0, field.height, from, course.columns ? size_t(field.width) : fields.rows.stride, rows);
            use(wayOf[way], 0, rows);
            isDone[wayOf[way]] = true;
            throwIfStopped(progress, double(std::count(isDone.begin(), isDone.end(), true)) / double(azimuths.size()));
        }
    }
}

}  // namespace apertura
