#pragma once
// Bakes samples on faces by a recipe.
#include <span>

#include "apertura/bake/fit/bake.h"
#include "apertura/bake/fit/face.h"
#include "apertura/bake/fit/face_unknowns.h"
#include "apertura/bake/fit/fit.h"

namespace apertura {

// A sample is what its point sees, where that is what its faces' probes make of it together. Elsewhere, as where something touches the
// face, its rays start at the probes all around, and it is what is best between samples.
class FaceBaker {
public:
    // All must outlive it.
    FaceBaker(const Scene& scene, const Prober& prober, const OcclusionSource& source, const BakeOptions& options);

    // Bakes the samples of an instance: `seen` has levels and room, and what is fitted there. Returns how many rays it traced. Throws
    // Cancelled.
    //   faces     of the instance, with their probes
    //   unknowns  of the same: samples that are one unknown are baked once
    size_t bake(size_t instance, std::span<const Face> faces, const Unknowns& unknowns, SeenOnFaces& seen, ProgressCounter& counter) const;

    // A point of a face that a sample's rays start from, and its share of them.
    struct Origin {
        uint32_t face, probe;
        float weight;
    };

private:
    // Which of the lattice's directions, taken to the world by `frame`, are blocked: from one point; and each from one of several.
    std::vector<uint8_t> seenFrom(const SurfacePoint& point, const glm::mat3& frame) const;
    std::vector<uint8_t> seenAround(std::span<const Origin> origins, std::span<const Face> faces, const glm::mat3& frame,
                                    double start) const;

    const Prober& prober_;
    const OcclusionSource& source_;
    const BakeOptions& options_;
    const Recipe& recipe_;
    FitTools tools_;
    FitOptions fitOptions_;
};

}  // namespace apertura
