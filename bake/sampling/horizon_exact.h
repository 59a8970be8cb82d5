#pragma once
// Horizons along the line through each texel itself: exact on the triangles of a height field, at some eight times the time of a sweep.
#include <glm/glm.hpp>
#include <vector>

#include "apertura/bake/sampling/sweep_fields.h"

namespace apertura {

// The largest height in each square of a field, so that a line passes over far ground that lies lower than what it has met.
class HighestHeights {
public:
    explicit HighestHeights(const SweepField& field);

    // Texels a side of the squares, of either kind.
    static constexpr int kSides[2] = {64, 16};
    // No height within the rows y0 .. y1 and the columns x0 .. x1, all included, is larger; SweepField::kNone where that is outside the
    // field.
    float largest(int kind, int y0, int y1, int x0, int x1) const;
    float largest() const { return all_; }

private:
    int rows_[2], columns_[2];
    std::vector<float> heights_[2];
    int height_, width_;
    float all_ = SweepField::kNone;
};

// The way towards one azimuth, prepared for all texels of a field's rows.
struct ExactCourse {
    //   rows      rowsOf a field; `highest` is made of them. Both must outlive it
    //   perMetre  texels to the east and to the south
    //   limit     metres beyond which nothing counts; 0: none
    ExactCourse(const SweepField& rows, const HighestHeights& highest, const glm::dvec2& perMetre, double curvature, double limit);

    const SweepField& rows;
    const HighestHeights& highest;
    double step;                                 // metres, of a texel to the side in which most are crossed
    glm::dvec2 perStep;                          // texels to the east and to the south
    std::vector<SweepCrossing> crossings;        // by distance
    std::vector<size_t> first[2];                // of each length of HighestHeights::kSides steps: its first crossing, and one more
    std::vector<float> nearest[2], farthest[2];  // 1 / metres, of the crossings of each length
};

// The tangents of the horizons of the texels in the rows y0 .. y1 - 1, and in the columns from x to x + 7, kNoHorizon where there is none:
// those of a row go to to[(y - y0) * stride] and after. Of texels without a height, and of places outside the field, they have no meaning.
// The result is the same to the bit on all processors, and whatever the range.
void exactTangents(const ExactCourse& course, int y0, int y1, int x, float* to, size_t stride);

}  // namespace apertura
