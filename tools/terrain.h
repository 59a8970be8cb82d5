#pragma once
// Height maps that are swept, for the verbs that bake.
#include "apertura/bake/scene/height_map.h"

namespace apertura {

// The mesh that a height map is stored with: all of it, or as much as keeps the texels of its image within the error.
//   inTexels   an image lies over it
//   meshError  metres; negative: a tenth of a texel's shorter side
//   reached    becomes what was kept to, metres
// Throws Error naming `name` where the map has no triangle, or is too large; Cancelled.
Scene meshToSweep(const std::string& name, const HeightMap& map, bool inTexels, double meshError, double& reached);

}  // namespace apertura
