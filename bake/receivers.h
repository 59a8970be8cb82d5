#pragma once
// Where models are measured: points spread over a scene, and the lights that shine on them.
#include "bake/bake.h"

namespace apertura {

// A point inside a triangle, with the geometric normal (turned to the side of the vertex normals).
struct SpreadPoint {
    SurfacePoint at;
    int instance, triangle;
    glm::vec3 weights;  // barycentric
};

// `count` points over the receiving surfaces, inside the scene's receiver boxes, evenly by area.
// Throws Error naming the scene where it has no area there.
std::vector<SpreadPoint> spreadReceivers(const Scene& scene, int count, uint32_t seed);

// Directions of the lights at a receiver: 80 over the sky's hemisphere and 8 each at 3 and 8 degrees above
// its rim, turned by an angle of the receiver's own. It is the hemisphere about +Y where the scene says so
// (skyAboveGround), and the receiver's own otherwise.
std::vector<glm::vec3> lightDirections(const Scene& scene, const SurfacePoint& receiver, uint32_t seed, size_t index);

// Ray-traced E / (L pi sin^2 r) of cap lights at a receiver, from `samples` directions in each, in two
// interleaved halves: the mean is the truth, half their difference its noise.
struct TruthSample {
    float first, second;
    float mean() const { return (first + second) / 2; }
    float noise() const { return (first - second) / 2; }
};
TruthSample traceLight(const Tracer& tracer, const SurfacePoint& receiver, const glm::vec3& direction, double radius,
                       int samples, double spin);

}  // namespace apertura
