#pragma once
// Makes the lobes of neighbouring points the same lobes, moved. Alone, neighbours may fall into different optima that err the same: no
// RMSE shows it, but a viewer does see a hard edge that jumps from point to point.
#include "apertura/bake/fit/fit.h"
#include "apertura/bake/sampling/neighbours.h"
#include "apertura/bake/sampling/progress.h"

namespace apertura {

// A point that was fitted alone.
struct FittedPoint {
    BakedPoint baked;                // in the world
    glm::mat3 frame;                 // takes the lattice's directions to the world
    std::vector<uint64_t> openBits;  // Samples::bits
};

// True where `agree` can do something for the model.
bool canAgree(const Model& model);

// Iterated conditional modes (Besag, "On the Statistical Analysis of Dirty Pictures", 1986). In a few sweeps, a point takes the lobes of a
// neighbour, improved by its own rays, where these lower the sum of the fit's error (LobeFit::error) and kAgreement times the mean, over
// its neighbours, of the squared difference of what the two let through, weighed by cos^2. Of APERTURA_MODEL_AUTO, a point first takes the
// model that most of its neighbours have, where its price and error together are hardly more; then lobes are those of neighbours with the
// same model. A point without neighbours stays as it is. The result does not depend on the number of threads. Throws Cancelled.
//   tools, options  those that the points were fitted with
void agree(const Model& model, const FitTools& tools, const FitOptions& options, std::span<FittedPoint> points,
           const Neighbours& neighbours, uint32_t seed, const Progress& progress);

}  // namespace apertura
