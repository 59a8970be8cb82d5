#define APERTURA_LANES plain
#include "apertura/bake/sampling/horizon_exact.inc"

#include <algorithm>
#include <cmath>

namespace apertura {

HighestHeights::HighestHeights(const SweepField& rows) : height_(rows.along), width_(rows.across) {
    for (int kind = 0; kind < 2; ++kind) {
        const int side = kSides[kind];
        rows_[kind] = (height_ + side - 1) / side, columns_[kind] = (width_ + side - 1) / side;
        heights_[kind].assign(size_t(rows_[kind]) * size_t(columns_[kind]), SweepField::kNone);
        for (int y = 0; y < height_; ++y) {
            float* const row = &heights_[kind][size_t(y / side) * size_t(columns_[kind])];
            const float* const from = &rows.heights[rows.at(y, 0)];
            for (int x = 0; x < width_; ++x) row[x / side] = std::max(row[x / side], from[x]);
        }
    }
    for (const float h : heights_[0]) all_ = std::max(all_, h);
}

float HighestHeights::largest(int kind, int y0, int y1, int x0, int x1) const {
    y0 = std::max(y0, 0), x0 = std::max(x0, 0), y1 = std::min(y1, height_ - 1), x1 = std::min(x1, width_ - 1);
    float out = SweepField::kNone;
    if (y0 > y1 || x0 > x1) return out;
    const int side = kSides[kind];
    for (int row = y0 / side; row <= y1 / side; ++row)
        for (int column = x0 / side; column <= x1 / side; ++column)
            out = std::max(out, heights_[kind][size_t(row) * size_t(columns_[kind]) + size_t(column)]);
    return out;
}

ExactCourse::ExactCourse(const SweepField& rows_, const HighestHeights& highest_, const glm::dvec2& perMetre, double curvature,
                         double limit)
    : rows(rows_), highest(highest_), step(1 / std::max(std::abs(perMetre.x), std::abs(perMetre.y))), perStep(step * perMetre) {
    for (int axis = 0; axis < 2; ++axis)
        if (std::abs(perStep[axis] - std::round(perStep[axis])) < 1e-9) perStep[axis] = std::round(perStep[axis]);
    // No line leaves the field on two sides.
    const glm::dvec2 size(rows.across - 1, rows.along - 1);
    double reach = 1e300;
    for (int axis = 0; axis < 2; ++axis)
        if (perStep[axis] != 0) reach = std::min(reach, std::ceil(size[axis] / std::abs(perStep[axis])));
    if (limit > 0) reach = std::min(reach, std::ceil(limit / step));
    crossings = crossingsOf(rows.stride, perStep, step, curvature, int(reach));
    if (limit > 0) std::erase_if(crossings, [&](const SweepCrossing& c) { return c.inverse * limit < 1; });
    std::stable_sort(crossings.begin(), crossings.end(),
                     [](const SweepCrossing& p, const SweepCrossing& q) { return p.inverse > q.inverse; });
    for (int kind = 0; kind < 2; ++kind) {
        const double length = HighestHeights::kSides[kind] * step;
        size_t at = 0;
        first[kind].push_back(0);
        while (at < crossings.size()) {
            const double end = double(first[kind].size()) * length;
            nearest[kind].push_back(crossings[at].inverse);
            // A crossing at the very end belongs to this length, whichever way its distance was rounded.
            do ++at;
            while (at < crossings.size() && crossings[at].inverse * end >= 1 - 1e-6);
            farthest[kind].push_back(crossings[at - 1].inverse);
            first[kind].push_back(at);
        }
    }
}

#ifdef APERTURA_AVX2
namespace avx2 {
void exactTangents(const ExactCourse& course, int y0, int y1, int x, float* to, size_t stride);
}  // namespace avx2
#endif

void exactTangents(const ExactCourse& course, int y0, int y1, int x, float* to, size_t stride) {
#ifdef APERTURA_AVX2
    static const bool wide = __builtin_cpu_supports("avx2");
    if (wide) return avx2::exactTangents(course, y0, y1, x, to, stride);
#endif
    plain::exactTangents(course, y0, y1, x, to, stride);
}

}  // namespace apertura
