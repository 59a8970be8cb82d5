#include "apertura/bake/fit/agree.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <map>

#include "apertura/bake/fit/choose.h"
#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/sampling/progress.h"

namespace apertura {
namespace {

constexpr double kAgreement = 0.3;
constexpr int kSweeps = 3;
constexpr double kShare = 0.6;         // of the points look about in a sweep: if all did at once, neighbours would swap their lobes
constexpr int kDirections = 64;        // in which two points are compared
constexpr int kSteps = 4;              // by which a neighbour's lobes are improved
constexpr size_t kCandidates = 5;      // neighbours' lobes that a point tries, at most
constexpr double kChoiceShare = 0.05;  // `auto`: what a neighbour's model may cost more, so that a point takes it
constexpr double kAlike = 0.002;       // lobes that let through what others do, to this mean square, are not tried again

using Seen = std::vector<float>;  // what a point lets through in each of the directions

// The mean square of cos times the difference, over the mean of cos^2.
double difference(std::span<const vec3> directions, const Seen& a, const Seen& b) {
    double sum = 0;
    for (size_t i = 0; i < directions.size(); ++i) {
        const double off = directions[i].z * (a[i] - b[i]);
        sum += off * off;
    }
    return 3 * sum / double(directions.size());
}

Samples samplesOf(const SampleLattice& lattice, const FittedPoint& point) {
    std::vector<uint8_t> blocked(lattice.byHeight.size());
    for (size_t i = 0; i < blocked.size(); ++i) blocked[size_t(lattice.byHeight[i])] = !(point.openBits[i / 64] >> i % 64 & 1);
    return Samples(lattice, blocked);
}

// Points of one model, and the lobes that one of them might have.
class Point {
public:
    Point(const Model& model, const SampleLattice& lattice, const FittedPoint& point, std::span<const vec3> directions)
        : model_(model), form_(*lobeFormOf(model.id)), point_(point), directions_(directions), samples_(samplesOf(lattice, point)) {}

    Seen seenBy(const ModelParams& world) const { return visibleTo(directions_, model_, {{}, toLocal(world)}); }

    // The error of lobes as they are; softer edges are preferred by as much as where points are fitted alone.
    double errorOf(const ModelParams& world) const { return priced(improveLobes(samples_, lobes(world), stepped(0))); }

    // Improves `world` by the point's own rays, and returns what errorOf would.
    double improve(ModelParams& world) const {
        const LobeFit fit = improveLobes(samples_, lobes(world), stepped(kSteps));
        world = rotateParams(model_, form_.toParams(fit), point_.frame);
        return priced(fit);
    }

private:
    ModelParams toLocal(const ModelParams& world) const { return rotateParams(model_, world, transpose(point_.frame)); }
    LobeFit lobes(const ModelParams& world) const { return form_.toLobes(toLocal(world)); }
    LobeFitOptions stepped(int steps) const {
        LobeFitOptions options = form_.options;
        options.steps = steps;
        return options;
    }
    double priced(const LobeFit& fit) const {
        const bool isHard = form_.options.softer > 0
                         && length(vec3(fit.lobes[0])) > 0.5f * (form_.options.softer + form_.options.sharpness);
        return fit.error * (isHard ? 1 + form_.options.softerShare : 1);
    }

    const Model& model_;
    const LobeForm& form_;
    const FittedPoint& point_;
    std::span<const vec3> directions_;
    Samples samples_;
};

// What the point is best to have, given its neighbours.
ModelParams bestOf(const Model& model, const SampleLattice& lattice, std::span<const FittedPoint> points, size_t own,
                   std::span<const uint32_t> near, std::span<const vec3> directions) {
    const Point point(model, lattice, points[own], directions);
    std::vector<Seen> theirs;
    for (const uint32_t n : near) theirs.push_back(point.seenBy(points[n].baked.params));
    const auto cost = [&](double error, const Seen& seen) {
        double sum = 0;
        for (const Seen& other : theirs) sum += difference(directions, seen, other);
        return error + kAgreement * sum / double(theirs.size());
    };
    ModelParams best = points[own].baked.params;
    std::vector<Seen> tried{point.seenBy(best)};
    double least = cost(point.errorOf(best), tried[0]);
    for (size_t n = 0; n < near.size() && tried.size() <= kCandidates; ++n) {
        const auto alike = [&](const Seen& other) { return difference(directions, theirs[n], other) < kAlike; };
        if (std::any_of(tried.begin(), tried.end(), alike)) continue;
        tried.push_back(theirs[n]);
        ModelParams params = points[near[n]].baked.params;
        const double error = point.improve(params);
        if (const double sum = cost(error, point.seenBy(params)); sum < least) least = sum, best = params;
    }
    return best;
}

}  // namespace

bool canAgree(const Model& model) { return model.id == APERTURA_MODEL_AUTO || lobeFormOf(model.id); }

namespace {

// The choice of `auto` at a point after a look at its neighbours.
BakedPoint choiceOf(const FitTools& tools, const FitOptions& options, std::span<const FittedPoint> points, size_t own,
                    std::span<const uint32_t> near) {
    const Model& choosing = models()[APERTURA_MODEL_AUTO];
    const auto modelOf = [&](size_t i) { return &chosenModel(choosing, points[i].baked.params); };
    std::map<int, size_t> counts;
    for (const uint32_t n : near) ++counts[modelOf(n)->id];
    const auto most = std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    const BakedPoint& now = points[own].baked;
    if (most == counts.end() || 2 * most->second <= near.size() || most->first == modelOf(own)->id) return now;
    return withModel(tools, samplesOf(tools.lattice, points[own]), points[own].frame, options, now, models()[size_t(most->first)],
                     kChoiceShare);
}

}  // namespace

void agree(const Model& model, const FitTools& tools, const FitOptions& options, std::span<FittedPoint> points,
           const Neighbours& neighbours, uint32_t seed, const Progress& progress) {
    const std::vector<vec3> directions = fibonacciHemisphere(kDirections);
    const bool isChoice = model.id == APERTURA_MODEL_AUTO;
    std::vector<BakedPoint> next(points.size());
    ProgressCounter counter(progress, (kSweeps + isChoice) * points.size());
    const auto sweep = [&](auto&& bakedAt) {
        tbb::parallel_for(tbb::blocked_range<size_t>(0, points.size(), 16), [&](const tbb::blocked_range<size_t>& range) {
            for (size_t i = range.begin(); i < range.end() && !counter.stopped(); ++i) {
                next[i] = bakedAt(i);
                counter.add(1);
            }
        });
        counter.throwIfStopped();
        for (size_t i = 0; i < points.size(); ++i) points[i].baked = next[i];
    };
    if (isChoice) sweep([&](size_t i) { return choiceOf(tools, options, points, i, neighbours.of(i)); });
    for (int n = 0; n < kSweeps; ++n)
        sweep([&](size_t i) {
            BakedPoint baked = points[i].baked;
            const Model& own = chosenModel(model, baked.params);
            if (!lobeFormOf(own.id) || hashUnit(seed, i, 200 + size_t(n)) > kShare) return baked;
            std::vector<uint32_t> near;
            for (const uint32_t other : neighbours.of(i))
                if (&chosenModel(model, points[other].baked.params) == &own) near.push_back(other);
            if (near.empty()) return baked;
            const bool outOfReach = isChoice && aperturaChoiceIn(baked.params[APERTURA_CHOICE_SLOT]).outOfReach;
            baked.params = bestOf(own, tools.lattice, points, i, near, directions);
            if (isChoice) setChoice(baked.params, own, outOfReach);
            return baked;
        });
}

}  // namespace apertura
