#include "apertura/bake/sampling/horizon_exact.h"

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

ExactHorizons::ExactHorizons(const SweepField& field, const HighestHeights& highest, const SweepCourse& course, int way, double farthest)
    : field_(field), highest_(highest), shift_(course.direction.shift * (way ? -1 : 1)), step_(course.step), sign_(way ? -1 : 1) {
    // No line is longer than the field, nor goes farther across than it is wide.
    double reach = field.along - 1;
    if (shift_ != 0) reach = std::min(reach, std::ceil((field.across - 1) / std::abs(shift_)));
    if (farthest > 0) reach = std::min(reach, std::ceil(farthest / course.step));
    crossings_ = crossingsOf(field, course, way, int(reach));
    if (farthest > 0) std::erase_if(crossings_, [&](const SweepCrossing& c) { return c.inverse * farthest < 1; });
    std::stable_sort(crossings_.begin(), crossings_.end(),
                     [](const SweepCrossing& x, const SweepCrossing& y) { return x.inverse > y.inverse; });
    for (int kind = 0; kind < 2; ++kind) {
        const double length = HighestHeights::kSides[kind] * course.step;
        size_t at = 0;
        first_[kind].push_back(0);
        while (at < crossings_.size()) {
            const double end = double(first_[kind].size()) * length;
            nearest_[kind].push_back(crossings_[at].inverse);
            // A crossing at the very end belongs to this length, whichever way its distance was rounded.
            while (at < crossings_.size() && crossings_[at].inverse * end >= 1 - 1e-6) ++at;
            farthest_[kind].push_back(crossings_[at - 1].inverse);
            first_[kind].push_back(at);
        }
    }
}

Floats ExactHorizons::tangents(int a, int b) const {
    const float* const own = &field_.heights[field_.at(a, b)];
    Floats z = load(own), best = all(kNoHorizon);
    z = z > SweepField::kNone / 2 ? z : all(-SweepField::kNone);  // sees nothing, and nothing has to be looked at for it
    const auto isHidden = [&](float height, float nearest, float farthest) {
        const Floats rise = height - z;
        return !any(rise * (rise > 0.0f ? all(nearest) : all(farthest)) > best);
    };
    const auto highestOf = [&](int kind, size_t length) {
        const int side = HighestHeights::kSides[kind], from = int(length) * side, to = from + side;
        const double ends[2] = {shift_ * from, shift_ * to};
        return highest_.largest(kind, sign_ > 0 ? a + from : a - to, sign_ > 0 ? a + to : a - from,
                                b + int(std::floor(std::min(ends[0], ends[1]))),
                                b + int(std::ceil(std::max(ends[0], ends[1]))) + kLanes - 1);
    };
    // Beyond its last crossing within the field a line would meet what lies elsewhere in memory.
    double steps = sign_ > 0 ? field_.along - 1 - a : a;
    if (shift_ != 0) steps = std::min(steps, (shift_ > 0 ? field_.across - 1 - b : b + kLanes - 1) / std::abs(shift_));
    const auto last = float((1 - 1e-6) / std::max(steps * step_, 1e-30));
    constexpr int kParts = HighestHeights::kSides[0] / HighestHeights::kSides[1];
    for (size_t outer = 0; outer < nearest_[0].size(); ++outer) {
        // Beyond this length the ground may be as high as anywhere.
        if (isHidden(highest_.largest(), nearest_[0][outer], farthest_[0].back())) break;
        const float high = highestOf(0, outer);
        if (high <= SweepField::kNone) break;  // the line has left the field
        if (isHidden(high, nearest_[0][outer], farthest_[0][outer])) continue;
        for (size_t inner = outer * kParts; inner < std::min((outer + 1) * kParts, nearest_[1].size()); ++inner) {
            const float higher = highestOf(1, inner);
            if (higher <= SweepField::kNone) break;
            if (isHidden(higher, nearest_[1][inner], farthest_[1][inner])) continue;
            for (size_t c = first_[1][inner]; c < first_[1][inner + 1]; ++c) {
                const SweepCrossing& crossing = crossings_[c];
                if (crossing.inverse < last) return best;
                const Floats from = load(own + crossing.from), to = load(own + crossing.to);
                best = larger(best, (from + crossing.weight * (to - from) - crossing.drop - z) * crossing.inverse);
            }
        }
    }
    return best;
}

}  // namespace apertura
