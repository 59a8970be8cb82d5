#pragma once
// The least model that a point needs.
#include "bake/fit/fit.h"

namespace apertura {

// The lights that models are judged by, over a lattice.
std::vector<FitTools::Probes> makeProbes(const SampleLattice& lattice);

// What a model has of each direction of the lattice at a point, 0..1; in the samples' frame, the normal +Z.
std::vector<float> visibleTo(const SampleLattice& lattice, const Model& model, const BakedPoint& point);

// RMSE of E / (L pi sin^2 r) over the probes of one radius, from the same directions as the samples', so that
// what a finite number of rays does to a light's edge is in both.
double probeError(const FitTools& tools, const FitTools::Probes& probes, const Samples& samples, std::span<const float> visible);

// A model that `auto` may choose, and the recipe that makes it.
struct Candidate {
    const Model* model;
    const Recipe* recipe;
};

// All of them, by how many numbers their light's formula reads.
std::span<const Candidate> candidates();

using CandidateErrors = std::vector<double>;  // the larger of the two probes' RMSE, a candidate

CandidateErrors tryCandidates(const FitTools& tools, const Samples& samples, const mat3& frame);

// Fewest numbers for an RMSE over all points of `tolerance`: every point takes the candidate with the least
// numbers + lambda * error^2, and this is the lambda at which it comes out so. Where no model reaches it, the
// lambda ends where a further number gains less than a third of the squared tolerance.
double lambdaFor(std::span<const CandidateErrors> points, double tolerance);

// Recipe's `make`, at the options' lambda: the parameters hold the chosen model's and the Choice.
BakedPoint chooseModel(const FitTools& tools, const Samples& samples, const mat3& frame, const FitOptions& options);

}  // namespace apertura
