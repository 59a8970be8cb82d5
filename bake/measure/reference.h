#pragma once
#include "apertura/bake/sampling/progress.h"
#include "apertura/bake/sampling/solids.h"
#include "apertura/runtime/asset/picture.h"
#include "apertura/runtime/asset/view.h"

namespace apertura {

struct ReferenceOptions {
    int lightRays = 8;  // to each light, per sample of the picture; there are 2 x 2 samples in a pixel
    int skyRays = 32;   // over the hemisphere, per sample
    int paths = 16;     // of light that bounces, per sample
    uint32_t seed = 1;
    int threads = 0;  // 0: one per core
};

// Ray traces the picture that the renderer approximates, in linear radiance. Camera, lights, samples of a pixel and vertex
// normals are the renderer's, so that the two pictures can be subtracted. Throws Cancelled.
Picture traceReference(const Tracer& tracer, const View& view, const ReferenceOptions& options, const Progress& progress = {});

// The irradiance of a point in that picture, rgb, W/m2.
glm::vec3 referenceIrradiance(const Tracer& tracer, const View& view, const SurfacePoint& point, const ReferenceOptions& options);

}  // namespace apertura
