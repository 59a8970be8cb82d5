#pragma once
// A height field as its sweeps walk over it, and the way of an azimuth through it.
#include <vector>

#include "apertura/bake/sampling/height_field.h"
#include "apertura/bake/sampling/horizon_sweep.h"

namespace apertura {

// The rows of a field, for horizons alone.
SweepField rowsOf(const HeightField& field);

// The two ways through a field: rows one after the other, and columns. Of each, what is across lies side by side in memory.
struct SweepFields {
    SweepField rows, columns;

    // `sums`: for sums over azimuths, else for horizons alone.
    SweepFields(const HeightField& field, bool sums);

    // Of a texel: the surface's slopes to the east and to the south.
    glm::vec2 slopeAt(int x, int y) const { return {rows.slopes[1][rows.at(y, x)], rows.slopes[0][rows.at(y, x)]}; }
    // And its sums: those of the direction to the east, up and to the south, and of the area.
    glm::vec4 sumAt(int x, int y) const {
        const size_t i = rows.at(y, x), j = columns.at(x, y);
        return {rows.horizontal[1][i] + columns.horizontal[0][j], rows.vertical[i] + columns.vertical[j],
                rows.horizontal[0][i] + columns.horizontal[1][j], rows.area[i] + columns.area[j]};
    }

    // What is laid out as `columns`, row after row as in the field that these were made of.
    void turnBack(const std::vector<float>& ofColumns, std::vector<float>& out) const;
};

// An azimuth through the one of the fields that it crosses less askew.
struct SweepCourse {
    bool columns;              // through SweepFields::columns
    bool backwards;            // the azimuth is the opposite of the direction's
    SweepDirection direction;  // without crossings
    double step;               // metres that it advances a texel along
    // As crossingsOf wants it, forwards (0) and backwards (1).
    glm::dvec2 perStep(int way) const { return way == 0 ? glm::dvec2(direction.shift, 1) : glm::dvec2(-direction.shift, -1); }
};

//   azimuth    radians from north by east
//   curvature  metres that the ground falls by, a squared metre
SweepCourse courseOf(const HeightField& field, double azimuth, double curvature);

// Where a line from a texel crosses edges of triangles, within `reach` steps; in no order.
//   stride   from one row of the heights to the next
//   perStep  texels that a step advances, side by side in memory and from row to row; the larger of the two is 1 or -1
//   step     metres
std::vector<SweepCrossing> crossingsOf(size_t stride, const glm::dvec2& perStep, double step, double curvature, int reach);

}  // namespace apertura
