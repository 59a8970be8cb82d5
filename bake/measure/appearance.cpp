#include "apertura/bake/measure/appearance.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "apertura/bake/measure/rows.h"
#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/sampling/neighbours.h"
#include "apertura/runtime/asset/receiver.h"

namespace apertura {
namespace {

using std::numbers::pi;
constexpr size_t kMostAround = 32;  // points about one, of which the mean is taken; a regular mesh has 18
constexpr size_t kPatches = 256, kLights = 32;
constexpr int kRays = 64;         // a light and point, for the truth
constexpr double kInside = 0.02;  // how far truth looks from inside its triangle, of the way to its middle
constexpr int kSteps = 16;        // along a line, to find edges of shadows
constexpr int kProfile = 41;      // places across an edge
constexpr float kFlat = 0.9998f;  // cosine, of the vertices' normals to the face's
constexpr double kHigh = 0.2;     // cosine, of the lights that edges are looked for under

SurfacePoint pointAt(const SurfaceAt& at, const glm::vec3& normal) { return {at.position, normal, at.longest}; }

glm::vec3 drawnIn(const glm::vec3& barycentrics) { return glm::mix(barycentrics, glm::vec3(1 / 3.0f), float(kInside)); }

// E / (L pi sin^2 r) of what is drawn, by light.
class Drawn {
public:
    Drawn(const Asset& asset, const Model& model, int instance, int triangle, const glm::vec3& barycentrics, const glm::vec3& normal)
        : model_(model.id), receivers_(receiverAt(asset, model, instance, triangle, barycentrics, normal)) {}
    double operator()(const AperturaCapLight& light) const {
        double sum = 0;
        for (const auto& [weight, receiver] : receivers_) sum += weight * modelValue(model_, receiver, light);
        return sum;
    }

private:
    int model_;
    WeightedReceivers receivers_;
};

AperturaCapLight lightOf(const glm::vec3& direction, double degrees) {
    return aperturaCapLight(direction, float(std::sin(degrees * pi / 180)));
}

}  // namespace

double mottleOf(std::span<const Patch> patches, std::span<const float> errors, std::span<const float> truth, size_t lights) {
    double sum = 0, count = 0;
    for (const Patch& patch : patches)
        for (size_t l = 0; l < lights && patch.size() > 1; ++l) {
            double meanError = 0, meanTruth = 0;
            for (size_t n = 1; n < patch.size(); ++n) {
                meanError += errors[patch[n] * lights + l];
                meanTruth += truth[patch[n] * lights + l];
            }
            const auto neighbours = double(patch.size() - 1);
            if (std::abs(truth[patch[0] * lights + l] - meanTruth / neighbours) >= kSmoothTruth) continue;
            const double off = errors[patch[0] * lights + l] - meanError / neighbours;
            sum += off * off;
            ++count;
        }
    return std::sqrt(sum / std::max(count, 1.0));
}

double edgeWidth(std::span<const double> at, std::span<const float> visible) {
    const auto [least, most] = std::minmax_element(visible.begin(), visible.end());
    if (*most - *least < 0.5f) return 0.8 * (at.back() - at.front());
    const auto grey = [&](size_t i) {
        const double v = std::clamp(double(visible[i]), 0.0, 1.0);
        return v * (1 - v);
    };
    // Of a ramp of length w the integral is w / 6, and 0.8 w lie between 10 and 90 %.
    double sum = 0;
    for (size_t i = 1; i < at.size(); ++i) {
        // v (1 - v) of what is linear between the two, by Simpson's rule, which is exact for it.
        const double middle = std::clamp(0.5 * (double(visible[i - 1]) + visible[i]), 0.0, 1.0);
        sum += (at[i] - at[i - 1]) * (grey(i - 1) + 4 * middle * (1 - middle) + grey(i)) / 6;
    }
    return 4.8 * sum;
}

Appearance::Appearance(const Asset& asset, const Tracer& tracer, std::span<const SurfaceSample> receivers, std::vector<double> radii,
                       uint32_t seed, const Progress& progress)
    : asset_(asset), seed_(seed), radii_(std::move(radii)) {
    if (radii_.empty()) return;
    addPatches(receivers);
    truth_.assign(radii_.size(), std::vector<float>(points_.size() * kLights));
    edges_.resize(receivers.size());
    ProgressCounter counter(progress, patches_.size() + receivers.size());
    tbb::parallel_for(size_t(0), patches_.size(), [&](size_t p) {
        if (counter.stopped()) return;
        for (const uint32_t i : patches_[p]) {
            const Place& place = points_[i];
            const SurfacePoint point = pointAt(surfaceAt(asset.scene, place.instance, place.triangle, drawnIn(place.barycentrics)),
                                               place.normal);
            // All points of a patch are looked at by the same rays, so that these err alike.
            for (size_t r = 0; r < radii_.size(); ++r)
                for (size_t l = 0; l < kLights; ++l)
                    truth_[r][i * kLights + l] = traceLight(tracer, point, lights_[p * kLights + l], radii_[r] * pi / 180, kRays,
                                                            2 * pi * hashUnit(seed, p, 50 + l))
                                                     .mean();
        }
        counter.add(1);
    });
    tbb::parallel_for(size_t(0), receivers.size(), [&](size_t i) {
        if (counter.stopped()) return;
        edges_[i] = edgesAbout(tracer, receivers[i], i);
        counter.add(1);
    });
    counter.throwIfStopped();
}

void Appearance::addPatches(std::span<const SurfaceSample> receivers) {
    std::map<int, StoredPoints> stored;
    std::set<std::pair<int, uint32_t>> taken;
    for (const SurfaceSample& receiver : receivers) {
        if (patches_.size() == kPatches) break;
        const SeenOnFaces& faces = asset_.seen[size_t(receiver.instance)].faces;
        const Surface& surface = asset_.scene.surfaces[asset_.scene.instances[size_t(receiver.instance)].surface];
        const StoredPoints& there = stored.try_emplace(receiver.instance, asset_.scene, size_t(receiver.instance), &faces).first->second;
        // The stored point of the receiver's cell that is nearest.
        const int level = faces.level(size_t(receiver.triangle));
        AperturaLatticeCell cell{ivec3(0, 1, 2), receiver.weights};
        if (level > 0) cell = aperturaLatticeCell(receiver.weights, aperturaLatticeSteps(level));
        int nearest = 0;
        for (int c = 1; c < 3; ++c)
            if (cell.weights[c] > cell.weights[nearest]) nearest = c;
        const uint32_t own = there.firstTwin(level > 0 ? surface.positions.size() + faces.first[size_t(receiver.triangle)]
                                                             + size_t(cell.samples[nearest])
                                                       : surface.triangles[size_t(receiver.triangle)][size_t(nearest)]);
        std::vector<uint32_t> around = there.withinTwo(own);
        if (const size_t all = around.size(); all > kMostAround) {
            for (size_t n = 0; n < kMostAround; ++n) around[n] = around[n * all / kMostAround];
            around.resize(kMostAround);
        }
        if (around.empty() || !taken.insert({receiver.instance, own}).second) continue;
        Patch& patch = patches_.emplace_back();
        const auto add = [&](uint32_t point) {
            const StoredPoints::Place& place = there.place(point);
            patch.push_back(uint32_t(points_.size()));
            points_.push_back({receiver.instance, place.triangle, place.barycentrics,
                               surfaceAt(asset_.scene, receiver.instance, place.triangle, place.barycentrics).normal});
        };
        add(own);
        for (const uint32_t point : around) add(point);
        const glm::mat3 frame = frameFromZ(points_[patch[0]].normal, 2 * pi * hashUnit(seed_, patches_.size(), 31));
        for (const glm::vec3& w : fibonacciHemisphere(int(kLights))) lights_.push_back(frame * w);
    }
}

std::vector<Appearance::Edge> Appearance::edgesAbout(const Tracer& tracer, const SurfaceSample& receiver, size_t index) const {
    std::vector<Edge> out;
    const auto at = [&](const glm::vec3& barycentrics) {
        return surfaceAt(asset_.scene, receiver.instance, receiver.triangle, barycentrics);
    };
    const glm::vec3 face = receiver.at.normal;
    for (int c = 0; c < 3; ++c)
        if (dot(at(glm::vec3(c == 0, c == 1, c == 2)).normal, face) < kFlat) return out;
    const glm::mat3 frame = frameFromZ(face, 2 * pi * hashUnit(seed_, index, 41));
    size_t k = 0;
    for (const glm::vec3& w : fibonacciHemisphere(int(kLights))) {
        const glm::vec3 light = frame * w;
        if (++k % 4 || w.z < kHigh) continue;
        // A line through the receiver to the edges of its triangle.
        const float a = float(2 * hashUnit(seed_, index, 60 + k) - 1), b = float(2 * hashUnit(seed_, index, 90 + k) - 1);
        const glm::vec3 along(a, b - a, -b);
        float low = -1e30f, high = 1e30f;
        for (int c = 0; c < 3; ++c) {
            if (along[c] > 0) low = std::max(low, -receiver.weights[c] / along[c]);
            if (along[c] < 0) high = std::min(high, -receiver.weights[c] / along[c]);
        }
        if (!(high > low) || high > 1e29f || low < -1e29f) continue;
        const auto weightsAt = [&](double share) {
            return glm::max(receiver.weights + float(low + (high - low) * share) * along, glm::vec3(0));
        };
        const auto isOpen = [&](double share) {
            return !tracer.occluded(rayOrigin(tracer, pointAt(at(weightsAt(share)), face), kTruthOffset), light, kNoLimit);
        };
        bool open[kSteps];
        for (int i = 0; i < kSteps; ++i) open[i] = isOpen((i + 0.5) / kSteps);
        for (int i = 1; i + 2 < kSteps; ++i) {
            if (open[i] == open[i + 1] || open[i - 1] != open[i] || open[i + 2] != open[i + 1]) continue;
            double from = (i + 0.5) / kSteps, to = (i + 1.5) / kSteps;
            for (int n = 0; n < 20; ++n) (isOpen((from + to) / 2) == open[i] ? from : to) = (from + to) / 2;
            Edge edge;
            edge.light = light;
            const glm::dvec3 middle = at(weightsAt((from + to) / 2)).position;
            for (int n = 0; n < kProfile; ++n) {
                const double t = 2.0 * n / (kProfile - 1) - 1;  // places are dense at the edge
                const glm::vec3 weights = weightsAt((from + to) / 2 + t * t * t / kSteps);
                edge.places.push_back({receiver.instance, receiver.triangle, weights, face});
                edge.at.push_back(std::copysign(glm::length(at(weights).position - middle), t));
            }
            bool isWhole = false;
            for (const double radius : radii_) {
                std::vector<float> visible;
                visible.reserve(edge.places.size());
                for (const Place& place : edge.places)
                    visible.push_back(traceLight(tracer, pointAt(at(place.barycentrics), face), light, radius * pi / 180, kRays, 0).mean()
                                      / w.z);
                const auto [least, most] = std::minmax_element(visible.begin(), visible.end());
                const bool whole = *least < 0.05f && *most > 0.95f;
                edge.width.push_back(whole ? edgeWidth(edge.at, visible) : 0);
                isWhole |= whole;
            }
            if (isWhole) out.push_back(std::move(edge));
            break;  // one a light
        }
    }
    return out;
}

size_t Appearance::indexOf(double radius) const { return size_t(std::find(radii_.begin(), radii_.end(), radius) - radii_.begin()); }

double Appearance::mottle(const Model& model, double radius) const {
    const std::vector<float>& truth = truth_[indexOf(radius)];
    std::vector<float> errors(truth.size());
    tbb::parallel_for(size_t(0), patches_.size(), [&](size_t p) {
        for (const uint32_t i : patches_[p]) {
            const Place& place = points_[i];
            const Drawn drawn(asset_, model, place.instance, place.triangle, place.barycentrics, place.normal);
            for (size_t l = 0; l < kLights; ++l)
                errors[i * kLights + l] = float(drawn(lightOf(lights_[p * kLights + l], radius)) - truth[i * kLights + l]);
        }
    });
    return mottleOf(patches_, errors, truth, kLights);
}

double Appearance::edge(const Model& model, double radius) const {
    const size_t r = indexOf(radius);
    std::vector<double> drawnWidth(edges_.size(), 0), trueWidth(edges_.size(), 0);
    tbb::parallel_for(size_t(0), edges_.size(), [&](size_t i) {
        for (const Edge& edge : edges_[i]) {
            if (!(edge.width[r] > 0)) continue;
            std::vector<float> visible;
            for (const Place& place : edge.places) {
                const Drawn drawn(asset_, model, place.instance, place.triangle, place.barycentrics, place.normal);
                visible.push_back(float(drawn(lightOf(edge.light, radius)) / dot(edge.light, place.normal)));
            }
            drawnWidth[i] += edgeWidth(edge.at, visible);
            trueWidth[i] += edge.width[r];
        }
    });
    double drawn = 0, truth = 0;
    for (size_t i = 0; i < edges_.size(); ++i) drawn += drawnWidth[i], truth += trueWidth[i];
    return truth > 0 ? drawn / truth : 0;
}

}  // namespace apertura
