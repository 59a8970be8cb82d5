#pragma once
// Heights over a regular grid, as a sweep for horizons walks over them.
#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

namespace apertura {

// Texel (x, y) lies x spacingX metres to the east and y spacingZ metres to the south of the north-western one. Between texels the surface
// is two triangles a cell, parted by the diagonal from its north-eastern to its south-western corner; where one of the three corners has no
// data there is no triangle.
struct HeightField {
    int width = 0, height = 0;          // texels, 2 or more each
    double spacingX = 1, spacingZ = 1;  // metres
    std::vector<float> heights;         // metres, row after row; NaN: no data

    size_t texels() const { return size_t(width) * size_t(height); }
};

}  // namespace apertura
