#pragma once
// A height map as a grid of numbers, before it becomes a mesh.
#include <string>
#include <vector>

#include "apertura/bake/sampling/height_field.h"
#include "apertura/bake/scene/geotiff.h"
#include "apertura/bake/scene/load.h"

namespace apertura {

struct HeightMap {
    HeightField field;
    Georeference georeference;
    MapGrid grid;                    // what the file says of it, whatever the spacing is taken for
    std::vector<std::string> notes;  // a line each
};

// Reads a .png, .tif or .exr file of 2 x 2 texels or more in this process.
//   terrainRgb false  one channel, and perhaps a second of alpha: there is no data where that is 0
//   terrainRgb true   8 bits a channel, three or more of them
// Throws Error with the cause and without the path. A damaged file may crash the libraries that this calls.
HeightMap readHeights(const std::string& path, const HeightMapOptions& options);

// The same in a process of its own. Throws Error "PATH: cause", also where nothing tells the spacing, and where the field would take more
// than half of this machine's memory.
HeightMap loadHeights(const std::string& path, const HeightMapOptions& options);

// Throws Error naming `name` where a mesh of all texels would not fit into memory, or into an asset.
void requireMeshable(const std::string& name, const HeightField& field);

// A scene of these, an instance of each. Throws Error as validate does.
Scene terrainScene(const std::string& name, std::vector<Surface> surfaces);

}  // namespace apertura
