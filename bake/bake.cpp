#include "bake/bake.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <optional>

#include "bake/choose.h"
#include "bake/receivers.h"
#include "bake/watch.h"
#include "sh/shading.h"

namespace apertura {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kPricePoints = 400;  // over the surface, on which the price of `auto` is found

// Halves a list of directions at the median of their longest axis, so that every run of a power of two of
// them is a patch of the sphere: 16 for a packet of rays, others for fitting.
void orderInPatches(std::span<glm::vec3> directions) {
    if (directions.size() <= 2) return;
    glm::vec3 low(2), high(-2);
    for (const glm::vec3& d : directions) low = glm::min(low, d), high = glm::max(high, d);
    const glm::vec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const size_t half = std::bit_ceil(directions.size()) / 2;
    std::nth_element(directions.begin(), directions.begin() + ptrdiff_t(half), directions.end(),
                     [axis](const glm::vec3& a, const glm::vec3& b) { return a[axis] < b[axis]; });
    orderInPatches(directions.first(half));
    orderInPatches(directions.subspan(half));
}

}  // namespace

double hashUnit(uint32_t seed, uint64_t a, uint64_t b) {
    // SplitMix64's finaliser (Steele, Lea and Flood, "Fast splittable pseudorandom number generators", 2014).
    uint64_t x = (uint64_t(seed) + 1) * 0x9E3779B97F4A7C15ull + a * 0xD1B54A32D192ED03ull + b * 0x8CB92BA72F3D8DD7ull;
    for (int round = 0; round < 2; ++round) {
        x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
        x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
        x ^= x >> 31;
    }
    return double(x >> 11) * 0x1p-53;
}

glm::mat3 frameAbout(const glm::vec3& normal, double angle) {
    const glm::vec3 u = tangentTo(normal), v = glm::cross(normal, u);
    const float c = float(std::cos(angle)), s = float(std::sin(angle));
    return {c * u + s * v, c * v - s * u, normal};
}

std::vector<glm::vec3> capLattice(int n, double h) {
    // Fibonacci's lattice: even steps of height, turned by the golden angle.
    const double golden = kPi * (3 - std::sqrt(5.0));
    std::vector<glm::vec3> out;
    for (int i = 0; i < n; ++i) {
        const double down = h * (i + 0.5) / n, s = std::sqrt(down * (2 - down)), turn = std::fmod(golden * i, 2 * kPi);
        out.emplace_back(float(s * std::cos(turn)), float(s * std::sin(turn)), float(1 - down));
    }
    return out;
}

std::vector<glm::vec3> hemisphereLattice(int n) {
    std::vector<glm::vec3> out = capLattice(n, 1);
    orderInPatches(out);
    return out;
}

void samplePoints(const Tracer& tracer, std::span<const SurfacePoint> points, const SampleLattice& lattice,
                  const BakeOptions& options, const Progress& progress,
                  const std::function<void(size_t, const Samples&, const glm::mat3&)>& use) {
    std::optional<tbb::global_control> limit;
    if (options.threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, size_t(options.threads));

    const float distance = options.maxDistance > 0 ? float(options.maxDistance) : kNoLimit;
    Watch watch(progress, points.size());
    tbb::parallel_for(tbb::blocked_range<size_t>(0, points.size(), 8), [&](const tbb::blocked_range<size_t>& range) {
        std::vector<glm::vec3> directions(lattice.directions().size());
        std::vector<uint8_t> blocked(directions.size());
        for (size_t i = range.begin(); i < range.end() && !watch.stopped(); ++i) {
            const SurfacePoint& point = points[i];
            const glm::mat3 frame = frameAbout(point.normal, 2 * kPi * hashUnit(options.seed, i, 0));
            for (size_t k = 0; k < directions.size(); ++k) directions[k] = frame * lattice.directions()[k];
            tracer.occluded(rayOrigin(tracer, point), directions, distance, blocked.data());
            use(i, Samples(lattice, blocked), frame);
            watch.add(1);
        }
    });
    watch.throwIfStopped();
}

double priceAt(const Tracer& tracer, std::span<const SurfacePoint> points, const FitTools& tools, const BakeOptions& options, double tolerance,
               const Progress& progress) {
    std::vector<CandidateErrors> errors(points.size());
    samplePoints(tracer, points, tools.lattice, options, progress, [&](size_t i, const Samples& samples, const glm::mat3& frame) {
        errors[i] = tryCandidates(tools, samples, frame);
    });
    return priceFor(errors, tolerance);
}

std::vector<BakedPoint> bakePoints(const Tracer& tracer, std::span<const SurfacePoint> points,
                                   const BakeOptions& options, const Progress& progress) {
    const Recipe& recipe = *findRecipe(options.recipe);
    const FitTools tools(options.rays, useOf(recipe));
    const FitOptions how{options.tolerance, options.price};
    std::vector<BakedPoint> out(points.size());
    samplePoints(tracer, points, tools.lattice, options, progress, [&](size_t i, const Samples& samples, const glm::mat3& frame) {
        out[i] = makePoint(recipe, tools, samples, frame, how);
    });
    return out;
}

BakedVisibility bakeVertices(const Scene& scene, const Tracer& tracer, const BakeOptions& options,
                             const Progress& progress, Doubts* doubts) {
    std::optional<tbb::global_control> limit;
    if (options.threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, size_t(options.threads));
    const Progress placing = part(progress, 0, 0.1), pricing = part(progress, 0.1, 0.2), baking = part(progress, options.recipe == "auto" ? 0.2 : 0.1, 1);
    const VertexPoints vertices = placeVertices(scene, tracer, placing, doubts);
    const std::vector<SurfacePoint>& points = vertices.points;
    BakeOptions how = options;
    if (options.recipe == "auto") {
        std::vector<SurfacePoint> spread;
        for (const SpreadPoint& p : spreadReceivers(scene, std::min(kPricePoints, int(points.size())), options.seed)) spread.push_back(p.at);
        how.price = priceAt(tracer, spread, FitTools(options.rays, FitTools::Use::Choice), options, options.tolerance, pricing);
    }
    const std::vector<BakedPoint> baked = bakePoints(tracer, points, how, baking);
    const bool stored = findRecipe(options.recipe)->model >= 0;
    BakedVisibility out;
    for (const Instance& instance : scene.instances) {
        const size_t count = scene.surfaces[instance.surface].positions.size();
        out.push_back({std::vector<Visibility>(count), std::vector<Form>(stored ? count : 0)});
    }
    for (size_t k = 0; k < baked.size(); ++k) {
        const auto [instance, vertex] = vertices.places[k];
        out[instance].visibility[vertex] = baked[k].visibility;
        if (stored) out[instance].forms[vertex] = baked[k].form;
    }
    return out;
}

}  // namespace apertura
