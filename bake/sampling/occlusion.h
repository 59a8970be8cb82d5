#pragma once
// What blocks the sky over a point: asked ray by ray, or known otherwise.
#include <functional>
#include <span>

#include "bake/sampling/progress.h"
#include "bake/sampling/samples.h"
#include "bake/sampling/tracer.h"
#include "bake/sampling/vertices.h"

namespace apertura {

// Where the blocked directions of a point come from: rays here, a height field's horizons elsewhere.
class OcclusionSource {
public:
    virtual ~OcclusionSource() = default;
    // blocked[i] becomes 1 where nothing of the sky is seen along directions[i] (unit, world) from `point`, and 0
    // elsewhere; as many as directions. Called from any number of threads.
    virtual void occluded(const SurfacePoint& point, std::span<const glm::vec3> directions, uint8_t* blocked) const = 0;
};

// By Embree's rays. `tracer` outlives it.
class RayOcclusion : public OcclusionSource {
public:
    // maxDistance: metres beyond which nothing blocks; 0: no limit.
    explicit RayOcclusion(const Tracer& tracer, double maxDistance = 0)
        : tracer_(tracer), distance_(maxDistance > 0 ? float(maxDistance) : kNoLimit) {}
    void occluded(const SurfacePoint& point, std::span<const glm::vec3> directions, uint8_t* blocked) const override {
        tracer_.occluded(rayOrigin(tracer_, point), directions, distance_, blocked);
    }

private:
    const Tracer& tracer_;
    float distance_;  // metres
};

// What is seen from each point along the lattice's directions, spun by an angle of the point's own that is hashed from
// the seed and its index. Calls `use(i, samples, frame)` for each point from any thread; `frame` takes the lattice to
// the world. The result does not depend on the number of threads (0: all cores). Throws Cancelled.
void samplePoints(const OcclusionSource& source, std::span<const SurfacePoint> points, const SampleLattice& lattice, uint32_t seed,
                  int threads, const Progress& progress, const std::function<void(size_t, const Samples&, const glm::mat3&)>& use);

}  // namespace apertura
