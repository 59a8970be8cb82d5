#pragma once
// Visibility of height fields by a sweep for horizons, without rays.
#include "apertura/bake/fit/bake.h"
#include "apertura/bake/sampling/horizons.h"

namespace apertura {

struct TerrainReport {
    int azimuths = 0;                          // that were swept
    double areaError = 0, directionError = 0;  // OpenSky's; 0 where models are fitted
};

// As bakeScene, of a scene that is a mesh over the field (fullMesh, decimatedMesh): images have a texel for each of the field's, and
// vertices what their texel sees. Models that are fitted to samples are fitted to the horizons, at the vertices alone, in the directions
// that options.rays counts. It makes no samples on faces and no bent normals, and nothing is too far away to block. Throws as bakeScene
// does.
BakedVisibility bakeTerrain(const Scene& scene, const HeightField& field, const BakeOptions& options, const HorizonOptions& horizons,
                            const Progress& progress = {}, AutoPlan* plan = nullptr, TerrainReport* report = nullptr);

}  // namespace apertura
