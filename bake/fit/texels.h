#pragma once
// Visibility in images over texture coordinates, fitted so that what bilinear filtering makes of the texels is what was seen.
#include "apertura/bake/fit/bake.h"
#include "apertura/bake/sampling/probes.h"

namespace apertura {

struct TexelReport {
    size_t images = 0, texels = 0, drawn = 0;  // drawn: those that filtering reads somewhere on a surface
    double shared = 0;                         // fraction of these that triangles of two charts read
};

// Throws Error naming the scene and the mesh unless every instance has texture coordinates, within 0..1, whose triangles lie over each
// other in no more than a thousandth of what they cover. `side`: texels of each image across and down,
// unless it is that of a height map, which has the map's own.
void requireCharts(const Scene& scene, int side);

// Fits an image, or two of bent normals and occlusion, to each instance, to about three probes a texel. Where charts meet on the surface,
// both sides are drawn to be the same along the edge, but for bent normals. The result does not depend on the number of threads. Throws
// Cancelled.
TexelReport bakeTexels(const Scene& scene, const Prober& prober, int side, As as, BakedVisibility& out, const Progress& progress);

}  // namespace apertura
