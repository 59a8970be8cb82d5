#pragma once
// Where models are measured, and the ray-traced truth there.
#include <string>

#include "apertura/bake/sampling/surface_points.h"
#include "apertura/bake/sampling/tracer.h"
#include "apertura/bake/sampling/vertices.h"

namespace apertura {

// Where the receivers of a scene lie, and what lights them.
struct MeasuredRegion {
    SurfaceRegion region;
    bool skyAboveGround = false;  // lights lie on the hemisphere about +Y; false: about each receiver's normal
};

// For "builtin:NAME": the receivers and the sky that BuiltinScene states, if `scene` has as many surfaces. Otherwise the
// whole scene, with lights about each receiver's normal.
MeasuredRegion measuredRegion(const std::string& name, const Scene& scene);

// `count` points of sampleSurface over measuredRegion(scene.name). Throws as sampleSurface does.
std::vector<SurfaceSample> sampleReceivers(const Scene& scene, int count, uint32_t seed);

// Unit directions of the 96 lights at a receiver: 80 over the hemisphere and 8 each at 3 and 8 degrees above its rim, all
// turned about its pole by an angle that `seed` and the receiver's `index` give.
std::vector<glm::vec3> lightDirections(const MeasuredRegion& region, const SurfacePoint& receiver, uint32_t seed, size_t index);

// Ray-traced E / (L pi sin^2 r) of a cap light, from two interleaved halves of the rays: their mean is the truth, half
// their difference its sampling error.
struct TruthSample {
    float first, second;
    float mean() const { return (first + second) / 2; }
    float noise() const { return (first - second) / 2; }
};
//   direction  of the light, unit
//   radius     radians
//   samples    rays in all, even
//   spin       radians that the pattern of rays is turned by about `direction`
TruthSample traceLight(const Tracer& tracer, const SurfacePoint& receiver, const glm::vec3& direction, double radius, int samples,
                       double spin);

}  // namespace apertura
