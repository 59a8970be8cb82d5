#pragma once
// Bakes what surfaces reflect to each vertex and each sample on faces.
#include "apertura/bake/sampling/paths.h"
#include "apertura/runtime/asset/asset.h"

namespace apertura {

struct BounceOptions {
    Albedo albedo;
    int rays = 256;  // a point
    uint32_t seed = 1;
    int threads = 0;  // 0: all cores
};

struct BounceReport {
    int passes = 0;   // each finds one bounce more
    double left = 0;  // RMS of what all further bounces add to the shares, which is estimated and added, too
    size_t rays = 0;  // traced
    double mean = 0;  // of the shares
};

// Sets `bounces` of all instances and of their samples on faces: what surfaces reflect of a sky of one radiance, and from where that comes.
// Each point gathers from what its rays meet, by the visibility that is stored there, and by what that reflects in turn. What lies inside
// solids is filled in from what borders on it. The result does not depend on the number of threads. Throws Error naming the scene where an
// instance has images, which hold visibility alone; Cancelled.
BounceReport bakeBounces(const Scene& scene, const Tracer& tracer, BakedVisibility& seen, const BounceOptions& options,
                         const Progress& progress = {});

}  // namespace apertura
