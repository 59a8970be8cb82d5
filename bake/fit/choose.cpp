#include "apertura/bake/fit/choose.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "apertura/bake/sampling/directions.h"

namespace apertura {

std::vector<FitTools::Probes> makeProbes(const SampleLattice& lattice) {
    std::vector<FitTools::Probes> out;
    for (const double degrees : {5.0, 15.0}) {
        FitTools::Probes p{degrees * APERTURA_PI / 180, {}};
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

std::vector<float> visibleTo(std::span<const vec3> directions, const Model& model, const BakedPoint& point) {
    const vec3 normal(0, 0, 1);
    const AperturaReceiver receiver = toReceiver(
        point.visibility, toParams(model, point.visibility, model.isStored() ? &point.params : nullptr, normal), normal);
    std::vector<float> out;
    const float s = 1e-3f;
    for (const vec3& w : directions) {
        const AperturaCapLight light = aperturaCapLight(w, s);
        out.push_back(aperturaIrradianceThrough(model.id, receiver, light, APERTURA_LIGHTS_SUN)
                      / std::max(aperturaUnoccludedIrradiance(normal, light, APERTURA_LIGHTS_SUN), 1e-12f));
    }
    return out;
}

namespace {

constexpr double kDearest = 3;  // the largest lambda, in units of the price per squared tolerance

std::vector<Candidate> makeCandidates() {
    std::vector<Candidate> out;
    for (const Model* model : autoModels()) {
        out.push_back({model, &recipeFor(*model)});
        for (const Recipe& recipe : recipes())
            if (recipe.only == model->id) out.push_back({model, &recipe});
    }
    std::stable_sort(out.begin(), out.end(), [](const Candidate& a, const Candidate& b) { return a.model->numbers < b.model->numbers; });
    return out;
}

BakedPoint makeCandidate(const Candidate& candidate, const FitTools& tools, const Samples& samples, const mat3& frame, double& error) {
    BakedPoint point = candidate.recipe->make(tools, samples, frame, {});
    const std::vector<float> visible = visibleTo(tools.lattice.directions(), *candidate.model, point);
    error = 0;
    for (const FitTools::Probes& probes : tools.probes) error = std::max(error, probeError(tools, probes, samples, visible));
    setChoice(point.params, *candidate.model, false);
    return point;
}

// The candidates' places in rising order of their price; equal ones in their own order.
std::vector<size_t> orderBy(Price price) {
    std::vector<size_t> out(candidates().size());
    std::iota(out.begin(), out.end(), size_t(0));
    std::stable_sort(out.begin(), out.end(),
                     [&](size_t a, size_t b) { return priceOf(*candidates()[a].model, price) < priceOf(*candidates()[b].model, price); });
    return out;
}
const std::vector<size_t>& ordered(Price price) {
    static const std::vector<size_t> all[] = {orderBy(Price::Numbers), orderBy(Price::Bytes), orderBy(Price::Cycles)};
    return all[size_t(price)];
}

// Tries candidates in rising order of their price, up to the first within the tolerance. Calls error(i) for each one
// tried and returns the one of the least cost. `reached`: one was within the tolerance.
size_t pick(double tolerance, double lambda, Price price, auto&& error, bool& reached) {
    size_t best = 0;
    double least = 1e30;
    reached = false;
    for (const size_t i : ordered(price)) {
        const double e = error(i), cost = priceOf(*candidates()[i].model, price) + lambda * e * e;
        if (cost < least) least = cost, best = i;
        reached = e <= tolerance;
        if (reached) break;
    }
    return best;
}

}  // namespace

std::span<const Candidate> candidates() {
    static const std::vector<Candidate> all = makeCandidates();
    return all;
}

double priceOf(const Model& model, Price price) {
    return price == Price::Numbers ? model.numbers : price == Price::Bytes ? (model.isStored() ? storedNumbers(model) : 0) : model.cycles;
}

CandidateErrors tryCandidates(const FitTools& tools, const Samples& samples, const mat3& frame) {
    CandidateErrors out(candidates().size());
    for (size_t i = 0; i < out.size(); ++i) makeCandidate(candidates()[i], tools, samples, frame, out[i]);
    return out;
}

double lambdaFor(std::span<const CandidateErrors> points, double tolerance, Price price) {
    auto rmse = [&](double lambda) {
        double sum = 0;
        for (const CandidateErrors& errors : points) {
            bool reached;
            const double e = errors[pick(
                tolerance, lambda, price, [&](size_t i) { return errors[i]; }, reached)];
            sum += e * e;
        }
        return std::sqrt(sum / double(points.size()));
    };
    const double scale = priceOf(models()[APERTURA_MODEL_FIRM_4], price) / 12 / (tolerance * tolerance);
    double low = std::log(1e-3 * scale), high = std::log(kDearest * scale);
    for (int i = 0; i < 40; ++i) {
        const double middle = (low + high) / 2;
        (rmse(std::exp(middle)) <= tolerance ? high : low) = middle;
    }
    return std::exp(high);
}

const Model* leastAlone(std::span<const CandidateErrors> points, double tolerance, Price price) {
    for (const size_t i : ordered(price)) {
        double sum = 0;
        for (const CandidateErrors& errors : points) sum += errors[i] * errors[i];
        if (std::sqrt(sum / double(points.size())) <= tolerance) return candidates()[i].model;
    }
    return nullptr;
}

BakedPoint chooseModel(const FitTools& tools, const Samples& samples, const mat3& frame, const FitOptions& options) {
    std::vector<BakedPoint> made(candidates().size());
    bool reached;
    const size_t best = pick(
        options.tolerance, options.lambda, options.price,
        [&](size_t i) {
            double error;
            made[i] = makeCandidate(candidates()[i], tools, samples, frame, error);
            return error;
        },
        reached);
    setChoice(made[best].params, *candidates()[best].model, !reached);
    return made[best];
}

BakedPoint withModel(const FitTools& tools, const Samples& samples, const mat3& frame, const FitOptions& options, const BakedPoint& now,
                     const Model& model, double share) {
    const auto cost = [&](const Model& of, double error) { return priceOf(of, options.price) + options.lambda * error * error; };
    const Model& before = chosenModel(models()[APERTURA_MODEL_AUTO], now.params);
    const BakedPoint local{{transpose(frame) * now.visibility.direction, now.visibility.area},
                           rotateParams(before, now.params, transpose(frame))};
    double most = 0;
    const std::vector<float> visible = visibleTo(tools.lattice.directions(), before, local);
    for (const FitTools::Probes& probes : tools.probes) most = std::max(most, probeError(tools, probes, samples, visible));
    most = cost(before, most) * (1 + share);
    BakedPoint out = now;
    for (const Candidate& candidate : candidates()) {
        if (candidate.model != &model) continue;
        double error;
        BakedPoint made = makeCandidate(candidate, tools, samples, frame, error);
        if (cost(model, error) > most) continue;
        most = cost(model, error);
        setChoice(made.params, model, error > options.tolerance);
        out = {{frame * made.visibility.direction, made.visibility.area}, rotateParams(model, made.params, frame)};
    }
    return out;
}

}  // namespace apertura
