#pragma once
// Height maps as the rows of numbers that they are.
#include <string>
#include <vector>

#include "bake/scene/load.h"

namespace apertura {

struct HeightMap {
    int width = 0, height = 0;
    std::vector<float> values;  // metres where verticalScale is 1; row by row from the north-west; NaN where there is no data
};

// Reads .png .tif .exr in this process. Throws Error with the cause alone; the libraries that it calls may do worse with
// a damaged file, so that loadHeightMap calls it in a process of its own.
HeightMap readHeights(const std::string& path, const HeightMapOptions& options);

}  // namespace apertura
