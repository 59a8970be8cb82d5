#pragma once
// A height map as a grid of numbers, before it becomes a mesh.
#include <string>
#include <vector>

#include "apertura/bake/scene/load.h"

namespace apertura {

struct HeightMap {
    int width = 0, height = 0;
    std::vector<float> values;  // width * height, row by row from the north-west; metres if verticalScale is 1; NaN: no data
};

// Reads a .png, .tif or .exr file of 2 x 2 to 2^26 texels in this process. Of the options it uses terrainRgb alone.
//   terrainRgb false  one channel, and perhaps a second of alpha: there is no data where that is 0
//   terrainRgb true   8 bits a channel, three or more of them
// Throws Error with the cause and without the path. A damaged file may crash the libraries that this calls:
// loadHeightMap therefore calls it in a process of its own.
HeightMap readHeights(const std::string& path, const HeightMapOptions& options);

}  // namespace apertura
