#pragma once
// The least model that a point needs.
#include "bake/fit/fit.h"

namespace apertura {

// The lights that models are judged by, over a lattice.
std::vector<FitTools::Probes> makeProbes(const SampleLattice& lattice);

// What a model has of each direction of the lattice at a point, 0..1; in the samples' frame, the normal +Z.
std::vector<float> visibleTo(const SampleLattice& lattice, int model, const BakedPoint& point);

// RMSE of E / (L pi sin^2 r) over the probes of one radius, from the same directions as the samples', so that
// what a finite number of rays does to a light's edge is in both.
double probeError(const FitTools& tools, const FitTools::Probes& probes, const Samples& samples, std::span<const float> visible);

// The models that `auto` chooses among, by how many numbers their light's formula reads.
constexpr int kCandidates = 9;
using CandidateErrors = std::array<double, kCandidates>;  // the larger of the two probes' RMSE

CandidateErrors tryCandidates(const FitTools& tools, const Samples& samples, const mat3& frame);

// Fewest numbers for an RMSE over all points of `tolerance`: every point takes the candidate with the least
// numbers + lambda * error^2, and this is the lambda at which it comes out so. Where no model reaches it, the
// lambda ends where a further number gains less than a third of the squared tolerance.
double lambdaFor(std::span<const CandidateErrors> points, double tolerance);

// Recipe's `make`, at the options' lambda. params[4] has the chosen model in y and, where no candidate comes
// within the tolerance at this point, 1 in z.
BakedPoint chooseModel(const FitTools& tools, const Samples& samples, const mat3& frame, const FitOptions& options);

}  // namespace apertura
