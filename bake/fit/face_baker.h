#pragma once
// Bakes samples on faces by a recipe, each from rays that start all around it.
#include <span>

#include "apertura/bake/fit/bake.h"
#include "apertura/bake/fit/face.h"
#include "apertura/bake/fit/face_unknowns.h"
#include "apertura/bake/fit/fit.h"

namespace apertura {

class FaceBaker {
public:
    // All must outlive it.
    FaceBaker(const Scene& scene, const Prober& prober, const OcclusionSource& source, const BakeOptions& options);

    // Bakes the samples of an instance: `seen` has levels and room. Returns how many rays it traced. Throws Cancelled.
    //   faces     of the instance, with their probes, from which the rays of the samples about them start
    //   unknowns  of the same: samples that are one unknown are baked once
    size_t bake(size_t instance, std::span<const Face> faces, const Unknowns& unknowns, SeenOnFaces& seen, ProgressCounter& counter) const;

private:
    const Prober& prober_;
    const OcclusionSource& source_;
    const BakeOptions& options_;
    const Recipe& recipe_;
    FitTools tools_;
    FitOptions fitOptions_;
};

}  // namespace apertura
