#pragma once
// Chooses the model of the fewest numbers that a point needs.
#include "apertura/bake/fit/fit.h"

namespace apertura {

// The lights that models are judged by: 160 over the hemisphere, at radii of 5 and of 15 degrees.
std::vector<FitTools::Probes> makeProbes(const SampleLattice& lattice);

// The visibility, 0..1, that a model has at a point for each direction. In the samples' frame: the normal is +Z, and all directions lie
// above it.
std::vector<float> visibleTo(std::span<const vec3> directions, const Model& model, const BakedPoint& point);

// RMSE of E / (L pi sin^2 r) over the probes of one radius r, to a factor of (1 + cos r) / 2, which is 0.98 at 15
// degrees. `visible`: from visibleTo. Model and truth are summed over the same directions, so both have the error that a
// finite number of rays makes at a light's edge.
double probeError(const FitTools& tools, const FitTools::Probes& probes, const Samples& samples, std::span<const float> visible);

// A model that `auto` may choose, and the recipe that makes it.
struct Candidate {
    const Model* model;
    const Recipe* recipe;
};

// What a point of the model costs. For bytes the three that store nothing cost nothing.
double priceOf(const Model& model, Price price);

// All candidates, in rising order of the numbers that their light formula reads.
std::span<const Candidate> candidates();

using CandidateErrors = std::vector<double>;  // for each candidate, the larger of the two radii's RMSE

// Makes every candidate for one point. `frame` takes the samples' directions to the world.
CandidateErrors tryCandidates(const FitTools& tools, const Samples& samples, const mat3& frame);

// The lambda at which `auto` pays the least for an RMSE of `tolerance` over all points, if every point takes the candidate with the least
// price + lambda * error^2. Where no lambda reaches the tolerance, the result is 3 units / tolerance^2, a unit being a twelfth of the
// price of APERTURA_MODEL_FIRM_4, which reads twelve numbers: a further unit must then gain a third of tolerance^2.
double lambdaFor(std::span<const CandidateErrors> points, double tolerance, Price price = Price::Numbers);

// The least model, by its price, that alone keeps an RMSE of `tolerance` over all points; nullptr where none does.
const Model* leastAlone(std::span<const CandidateErrors> points, double tolerance, Price price = Price::Numbers);

// The `make` of the recipe "auto", at options.lambda: the result's params hold those of the chosen model, and its Choice.
BakedPoint chooseModel(const FitTools& tools, const Samples& samples, const mat3& frame, const FitOptions& options);

// The point of another model, in the world as `now`, where that costs (price + lambda * error^2) no more than 1 + `share` times what `now`
// does; else `now`.
BakedPoint withModel(const FitTools& tools, const Samples& samples, const mat3& frame, const FitOptions& options, const BakedPoint& now,
                     const Model& model, double share);

}  // namespace apertura
