#pragma once
// Horizons along the line through each texel itself: exact on the triangles of a height field, at some ten times the time of a sweep.
#include <memory>
#include <span>
#include <vector>

#include "apertura/bake/sampling/sweep_fields.h"

namespace apertura {

// The largest height in each square of a field, so that a line passes over far ground that lies lower than what it has met.
class HighestHeights {
public:
    explicit HighestHeights(const SweepField& field);

    // Texels a side of the squares, of either kind.
    static constexpr int kSides[2] = {64, 16};
    // No height within a0 .. a1 and b0 .. b1, texels, all included, is larger; SweepField::kNone where that is outside the field.
    float largest(int kind, int a0, int a1, int b0, int b1) const;
    float largest() const { return all_; }

private:
    int rows_[2], columns_[2];
    std::vector<float> heights_[2];
    int along_, across_;
    float all_ = SweepField::kNone;
};

// The way towards one azimuth, prepared for all texels.
struct ExactCourse {
    // `way` 0: in the course's direction, 1: opposite to it. `farthest`: metres beyond which nothing counts; 0: no limit. The field and
    // `highest`, which is made of it, must outlive it.
    ExactCourse(const SweepField& field, const HighestHeights& highest, const SweepCourse& course, int way, double farthest);

    const SweepField& field;
    const HighestHeights& highest;
    double shift;                                // texels across for each step along, in the direction of the way
    double step;                                 // metres
    int sign;                                    // of steps along
    std::vector<SweepCrossing> crossings;        // by distance
    std::vector<size_t> first[2];                // of each length of HighestHeights::kSides steps: its first crossing, and one more
    std::vector<float> nearest[2], farthest[2];  // 1 / metres, of the crossings of each length
};

// The tangents of the horizons of the texels at a0 .. a1 - 1 along, and from across `b` to b + 7, kNoHorizon where there is none, to places
// that are laid out as the field's heights. Of texels without a height, and of places outside the field, they have no meaning. The result
// is the same to the bit on all processors, and whatever the range.
void exactTangents(const ExactCourse& course, int a0, int a1, int b, float* to, size_t stride);

}  // namespace apertura
