#pragma once
// Horizons along the line through each texel itself: exact on the triangles of a height field, at some ten times the time of a sweep.
#include <memory>
#include <span>
#include <vector>

#include "apertura/bake/sampling/lanes.h"
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

// The horizons towards one azimuth.
class ExactHorizons {
public:
    // `way` 0: in the course's direction, 1: opposite to it. `farthest`: metres beyond which nothing counts; 0: no limit. Both must outlive
    // it.
    ExactHorizons(const SweepField& field, const HighestHeights& highest, const SweepCourse& course, int way, double farthest);

    // The tangents of the horizons of kLanes texels from (a, b), kNoHorizon where there is none. Of texels without a height or outside the
    // field they have no meaning.
    Floats tangents(int a, int b) const;

private:
    const SweepField& field_;
    const HighestHeights& highest_;
    double shift_;                                 // across for each step along, in the direction of the way
    double step_;                                  // metres
    int sign_;                                     // of steps along
    std::vector<SweepCrossing> crossings_;         // by distance
    std::vector<size_t> first_[2];                 // of each length of kSides steps: its first crossing, and one more
    std::vector<float> nearest_[2], farthest_[2];  // 1 / metres, of the crossings of each length
};

}  // namespace apertura
