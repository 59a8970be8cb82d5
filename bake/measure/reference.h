#pragma once
#include "bake/sampling/progress.h"
#include "bake/sampling/tracer.h"
#include "runtime/asset/picture.h"
#include "runtime/asset/view.h"

namespace apertura {

struct ReferenceOptions {
    int lightRays = 8;  // to each light, a sample of the picture
    int skyRays = 32;   // over the hemisphere, a sample
    uint32_t seed = 1;
    int threads = 0;
};

// The picture that the renderer approximates, ray traced: the same camera, lights, samples of a pixel and
// vertex normals, so that the two can be subtracted. Throws Cancelled.
Picture traceReference(const Tracer& tracer, const View& view, const ReferenceOptions& options, const Progress& progress = {});

}  // namespace apertura
