#define APERTURA_LANES plain
#include "apertura/bake/sampling/horizon_exact.inc"

#include <algorithm>
#include <cmath>

namespace apertura {

HighestHeights::HighestHeights(const SweepField& field) : along_(field.along), across_(field.across) {
    for (int kind = 0; kind < 2; ++kind) {
        const int side = kSides[kind];
        rows_[kind] = (along_ + side - 1) / side, columns_[kind] = (across_ + side - 1) / side;
        heights_[kind].assign(size_t(rows_[kind]) * size_t(columns_[kind]), SweepField::kNone);
        for (int a = 0; a < along_; ++a) {
            float* const row = &heights_[kind][size_t(a / side) * size_t(columns_[kind])];
            const float* const from = &field.heights[field.at(a, 0)];
            for (int b = 0; b < across_; ++b) row[b / side] = std::max(row[b / side], from[b]);
        }
    }
    for (const float h : heights_[0]) all_ = std::max(all_, h);
}

float HighestHeights::largest(int kind, int a0, int a1, int b0, int b1) const {
    a0 = std::max(a0, 0), b0 = std::max(b0, 0), a1 = std::min(a1, along_ - 1), b1 = std::min(b1, across_ - 1);
    float out = SweepField::kNone;
    if (a0 > a1 || b0 > b1) return out;
    const int side = kSides[kind];
    for (int row = a0 / side; row <= a1 / side; ++row)
        for (int column = b0 / side; column <= b1 / side; ++column)
            out = std::max(out, heights_[kind][size_t(row) * size_t(columns_[kind]) + size_t(column)]);
    return out;
}

ExactCourse::ExactCourse(const SweepField& field_, const HighestHeights& highest_, const SweepCourse& course, int way, double limit)
    : field(field_), highest(highest_), shift(course.direction.shift * (way ? -1 : 1)), step(course.step), sign(way ? -1 : 1) {
    // No line is longer than the field, nor goes farther across than it is wide.
    double reach = field.along - 1;
    if (shift != 0) reach = std::min(reach, std::ceil((field.across - 1) / std::abs(shift)));
    if (limit > 0) reach = std::min(reach, std::ceil(limit / step));
    crossings = crossingsOf(field, course, way, int(reach));
    if (limit > 0) std::erase_if(crossings, [&](const SweepCrossing& c) { return c.inverse * limit < 1; });
    std::stable_sort(crossings.begin(), crossings.end(),
                     [](const SweepCrossing& x, const SweepCrossing& y) { return x.inverse > y.inverse; });
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
void exactTangents(const ExactCourse& course, int a0, int a1, int b, float* to, size_t stride);
}  // namespace avx2
#endif

void exactTangents(const ExactCourse& course, int a0, int a1, int b, float* to, size_t stride) {
#ifdef APERTURA_AVX2
    static const bool wide = __builtin_cpu_supports("avx2");
    if (wide) return avx2::exactTangents(course, a0, a1, b, to, stride);
#endif
    plain::exactTangents(course, a0, a1, b, to, stride);
}

}  // namespace apertura
