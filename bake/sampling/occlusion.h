#pragma once
// What blocks the sky over points.
#include <functional>
#include <span>

#include "apertura/bake/sampling/progress.h"
#include "apertura/bake/sampling/samples.h"
#include "apertura/bake/sampling/tracer.h"
#include "apertura/bake/sampling/vertices.h"

namespace apertura {

// Finds the blocked directions of a point, by rays or otherwise.
class OcclusionSource {
public:
    virtual ~OcclusionSource() = default;
    // Sets blocked[i] to 1 where nothing of the sky is seen from `point` along directions[i] (unit, world), else to 0.
    // `blocked` has as many elements as `directions`. Called from several threads at once.
    virtual void occluded(const SurfacePoint& point, std::span<const glm::vec3> directions, uint8_t* blocked) const = 0;
};

// Finds them by Embree's rays. `tracer` must outlive it.
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

// Samples each point along the lattice's directions, spun about its normal by an angle that is hashed from `seed` and the
// point's index. The result does not depend on the number of threads. Throws Cancelled.
//   threads  at most; 0: all cores
//   use      use(i, samples, frame) is called once for each point, from any thread; `frame` takes the lattice to the
//            world
void samplePoints(const OcclusionSource& source, std::span<const SurfacePoint> points, const SampleLattice& lattice, uint32_t seed,
                  int threads, const Progress& progress, const std::function<void(size_t, const Samples&, const glm::mat3&)>& use);

}  // namespace apertura
