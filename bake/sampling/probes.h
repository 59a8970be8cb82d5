#pragma once
// Looks by few rays at many points of a triangle, from which its visibility is fitted.
#include "apertura/bake/sampling/occlusion.h"
#include "apertura/sh/sh4.h"

namespace apertura {

// What one point of a triangle sees, by two sets of rays: neither knows of the other's noise.
struct Probe {
    glm::vec3 weights;     // barycentric
    Visibility halves[2];  // world
    glm::vec3 bent;        // by all of them: the integral of V w (n . w) over the hemisphere about n, sr; world
    glm::vec3 normal;      // n, unit: about which it looks
    bool buried;           // inside something: nobody sees the point

    Visibility mean() const { return {0.5f * (halves[0].direction + halves[1].direction), 0.5f * (halves[0].area + halves[1].area)}; }
};

// Places and traces probes. Safe from any number of threads. What must outlive it: all that it is made from.
class Prober {
public:
    //   rays  of a baked sample: a probe has half as many, and a witness as many, within 128 .. 256
    Prober(const Scene& scene, const OcclusionSource& source, const Solids& solids, int rays, uint32_t seed);

    // The k-th probe of a triangle: the same one, however many there are. They spread evenly over it. Witnesses are other points, looked at
    // more closely: what is fitted to probes is judged by them.
    Probe probe(size_t instance, size_t triangle, size_t k) const { return look(instance, triangle, k, few_); }
    Probe witness(size_t instance, size_t triangle, size_t k) const { return look(instance, triangle, k, many_); }

    // Where the rays of a point of a triangle start.
    SurfacePoint pointAt(size_t instance, size_t triangle, const glm::vec3& weights) const;

    const Scene& scene() const { return scene_; }
    size_t rays() const { return rays_; }  // traced so far

    // How many witnesses take the rays of one baked sample, at least 1.
    double witnessesASample() const { return witnessesASample_; }

private:
    Probe look(size_t instance, size_t triangle, size_t k, const std::vector<glm::vec3>& directions) const;

    const Scene& scene_;
    const OcclusionSource& source_;
    const Solids& solids_;
    uint32_t seed_;
    std::vector<glm::vec3> few_, many_;  // directions
    double witnessesASample_;
    mutable std::atomic<size_t> rays_ = 0;
};

}  // namespace apertura
