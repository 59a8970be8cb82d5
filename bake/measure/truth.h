#pragma once
// Where models are measured, and what is traced there.
#include <string>

#include "bake/sampling/surface_points.h"
#include "bake/sampling/tracer.h"
#include "bake/sampling/vertices.h"

namespace apertura {

// Where the receivers of a scene lie, and what lights them.
struct MeasuredRegion {
    SurfaceRegion region;
    bool skyAboveGround = false;  // lights come from the hemisphere about +Y; else from each receiver's own
};

// Of builtin:NAME, what DESIGN's table has for it, where `scene` has as many surfaces; of any other name all of the
// scene, lit from everywhere.
MeasuredRegion measuredRegion(const std::string& name, const Scene& scene);

// `count` receivers of a scene of its own name; as sampleSurface.
std::vector<SurfaceSample> sampleReceivers(const Scene& scene, int count, uint32_t seed);

// Directions of the lights at a receiver: 80 over the sky's hemisphere and 8 each at 3 and 8 degrees above its rim,
// turned by an angle of the receiver's own.
std::vector<glm::vec3> lightDirections(const MeasuredRegion& region, const SurfacePoint& receiver, uint32_t seed, size_t index);

// Ray-traced E / (L pi sin^2 r) of cap lights at a receiver, from `samples` directions in each, in two
// interleaved halves: the mean is the truth, half their difference its noise.
struct TruthSample {
    float first, second;
    float mean() const { return (first + second) / 2; }
    float noise() const { return (first - second) / 2; }
};
TruthSample traceLight(const Tracer& tracer, const SurfacePoint& receiver, const glm::vec3& direction, double radius, int samples,
                       double spin);

}  // namespace apertura
