#include "bake/fit/choose.h"

#include <algorithm>
#include <cmath>

#include "bake/sampling/directions.h"

namespace apertura {

std::vector<FitTools::Probes> makeProbes(const SampleLattice& lattice) {
    std::vector<FitTools::Probes> out;
    for (const double degrees : {5.0, 15.0}) {
        FitTools::Probes p{degrees * PI / 180, {}};
        const float cosine = float(std::cos(p.radius));
        for (const vec3& light : fibonacciHemisphere(160)) {
            std::vector<int> inside;
            for (int i = 0; i < lattice.rays(); ++i)
                if (dot(light, lattice.directions()[size_t(i)]) >= cosine) inside.push_back(i);
            if (!inside.empty()) p.inside.push_back(std::move(inside));
        }
        out.push_back(std::move(p));
    }
    return out;
}

double probeError(const FitTools& tools, const FitTools::Probes& probes, const Samples& samples, std::span<const float> visible) {
    double sum = 0;
    for (const std::vector<int>& inside : probes.inside) {
        double off = 0;
        for (int i : inside) off += (visible[size_t(i)] - float(samples.isOpen(size_t(i)))) * tools.lattice.directions()[size_t(i)].z;
        sum += off * off / double(inside.size() * inside.size());
    }
    return std::sqrt(sum / double(std::max<size_t>(probes.inside.size(), 1)));
}

std::vector<float> visibleTo(const SampleLattice& lattice, int model, const BakedPoint& point) {
    const vec3 normal(0, 0, 1);
    const Model& lit = models()[size_t(model)];
    const Receiver receiver = toReceiver(point.visibility, toParams(lit, point.visibility, lit.storedFields ? &point.params : nullptr, normal), normal);
    std::vector<float> out;
    const float s = 1e-3f;
    for (const vec3& w : lattice.directions()) {
        const CapLight light = capLight(w, s);
        out.push_back(irradianceThrough(model, receiver, light, LIGHTS_SUN) / std::max(unoccludedIrradiance(normal, light, LIGHTS_SUN), 1e-12f));
    }
    return out;
}

namespace {

constexpr double kDearest = 3;  // of prices, in numbers for a squared tolerance

struct Candidate {
    std::string_view recipe;
    int model;
    int numbers() const { return models()[size_t(model)].numbers; }
};
constexpr Candidate kCandidate[kCandidates] = {
    {"sh", MODEL_AO},          {"sh", MODEL_APERTURE},    {"sh", MODEL_SOFT},        {"sh-fit", MODEL_SOFT},      {"firm-2", MODEL_FIRM_2},
    {"soft-2", MODEL_SOFT_2}, {"firm-3", MODEL_FIRM_3}, {"soft-l2", MODEL_SOFT_L2}, {"firm-4", MODEL_FIRM_4}};

BakedPoint makeCandidate(const Candidate& candidate, const FitTools& tools, const Samples& samples, const mat3& frame, double& error) {
    BakedPoint point = findRecipe(candidate.recipe)->make(tools, samples, frame, {});
    const std::vector<float> visible = visibleTo(tools.lattice, candidate.model, point);
    error = 0;
    for (const FitTools::Probes& probes : tools.probes) error = std::max(error, probeError(tools, probes, samples, visible));
    point.params[4].y = float(candidate.model);
    return point;
}

// Candidates are tried from the least on, and no further than the first within the tolerance. Calls
// error(i) for each; returns the one to take.
int pick(double tolerance, double lambda, auto&& error, bool& reached) {
    int best = 0;
    double least = 1e30;
    reached = false;
    for (int i = 0; i < kCandidates && !reached; ++i) {
        const double e = error(i), cost = kCandidate[i].numbers() + lambda * e * e;
        if (cost < least) least = cost, best = i;
        reached = e <= tolerance;
    }
    return best;
}

}  // namespace

CandidateErrors tryCandidates(const FitTools& tools, const Samples& samples, const mat3& frame) {
    CandidateErrors out;
    for (int i = 0; i < kCandidates; ++i) makeCandidate(kCandidate[i], tools, samples, frame, out[size_t(i)]);
    return out;
}

double lambdaFor(std::span<const CandidateErrors> points, double tolerance) {
    auto rmse = [&](double lambda) {
        double sum = 0;
        for (const CandidateErrors& errors : points) {
            bool reached;
            const double e = errors[size_t(pick(tolerance, lambda, [&](int i) { return errors[size_t(i)]; }, reached))];
            sum += e * e;
        }
        return std::sqrt(sum / double(points.size()));
    };
    const double scale = 1 / (tolerance * tolerance);
    double low = std::log(1e-3 * scale), high = std::log(kDearest * scale);
    for (int i = 0; i < 40; ++i) {
        const double middle = (low + high) / 2;
        (rmse(std::exp(middle)) <= tolerance ? high : low) = middle;
    }
    return std::exp(high);
}

BakedPoint chooseModel(const FitTools& tools, const Samples& samples, const mat3& frame, const FitOptions& options) {
    BakedPoint made[kCandidates];
    bool reached;
    const int best = pick(
        options.tolerance, options.lambda,
        [&](int i) {
            double error;
            made[i] = makeCandidate(kCandidate[i], tools, samples, frame, error);
            return error;
        },
        reached);
    made[best].params[4].z = reached ? 0 : 1;
    return made[best];
}

}  // namespace apertura
