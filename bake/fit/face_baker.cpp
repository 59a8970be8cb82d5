#include "apertura/bake/fit/face_baker.h"

#include <oneapi/tbb/parallel_for.h>

#include <atomic>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "apertura/bake/fit/agree.h"
#include "apertura/bake/fit/choose.h"
#include "apertura/bake/fit/rounding.h"
#include "apertura/bake/sampling/directions.h"
#include "apertura/runtime/asset/faces.h"

namespace apertura {
namespace {

constexpr float kInside = 0.05f;  // how far a sample looks from inside its triangle, of the way to its middle over the lattice's steps
// Of the hemisphere: where what a sample sees differs from what is fitted there by no more, or by so many times what its rays err,
// visibility is straight about it.
constexpr double kStraight = 0.015, kNoise = 3;

// How far the four numbers of samples are from others, of the hemisphere's area.
double difference(const Samples& samples, const glm::mat3& frame, const Visibility& other) {
    const Visibility own = project(samples);
    return glm::length(glm::vec4(frame * own.direction - other.direction, own.area - other.area)) / (2 * std::numbers::pi);
}

// A sample that is baked once, though several faces may have it.
struct Site {
    uint32_t face;
    int sample;
    std::vector<FaceBaker::Origin> origins;
};

// The samples of an instance's faces, and where each face's samples are among them.
struct Sites {
    std::vector<Site> all;
    std::vector<uint32_t> ofSample;  // as SeenOnFaces::visibility

    Sites(const Unknowns& unknowns, std::span<const Face> faces, const SeenOnFaces& seen) : ofSample(seen.visibility.size()) {
        std::unordered_map<uint32_t, uint32_t> byUnknown;
        for (uint32_t f = 0; f < faces.size(); ++f) {
            const Face& face = faces[f];
            const uint32_t first = face.level ? seen.first[face.triangle] : 0;
            for (int i = 0; i < samplesOn(face.level); ++i) {
                const std::vector<Term> terms = unknowns.sample(face.triangle, i);
                auto site = uint32_t(all.size());
                if (terms.size() == 1) site = byUnknown.try_emplace(terms[0].first, site).first->second;
                if (site == all.size()) all.push_back({f, i, {}});
                ofSample[first + uint32_t(i)] = site;
            }
            for (uint32_t p = 0; face.level && p < face.probes.size(); ++p) {
                if (face.probes[p].buried) continue;
                const AperturaLatticeCell cell = aperturaLatticeCell(face.probes[p].weights, aperturaLatticeSteps(face.level));
                for (int c = 0; c < 3; ++c)
                    if (cell.weights[c] > 0) all[ofSample[first + uint32_t(cell.samples[c])]].origins.push_back({f, p, cell.weights[c]});
            }
        }
    }

    // Sites that an edge of a cell joins.
    Neighbours neighbours(std::span<const Face> faces, const SeenOnFaces& seen) const {
        std::vector<std::pair<uint32_t, uint32_t>> edges;
        for (const Face& face : faces) {
            if (face.level == 0) continue;
            const uint32_t* own = &ofSample[seen.first[face.triangle]];
            forLatticeEdges(aperturaLatticeSteps(face.level), [&](int a, int b) { edges.emplace_back(own[a], own[b]); });
        }
        return Neighbours(all.size(), std::move(edges));
    }
};

}  // namespace

FaceBaker::FaceBaker(const Scene& scene, const Prober& prober, const OcclusionSource& source, const BakeOptions& options)
    : prober_(prober),
      source_(source),
      options_(options),
      recipe_(recipeNamed(options.recipe)),
      tools_(options.rays, useOf(recipe_)),
      fitOptions_{options.tolerance, options.lambda, options.price, scene.isTerrain} {}

std::vector<uint8_t> FaceBaker::seenFrom(const SurfacePoint& point, const glm::mat3& frame) const {
    std::vector<glm::vec3> turned;
    turned.reserve(tools_.lattice.directions().size());
    for (const glm::vec3& d : tools_.lattice.directions()) turned.push_back(frame * d);
    std::vector<uint8_t> blocked(turned.size());
    source_.occluded(point, turned, blocked.data());
    return blocked;
}

std::vector<uint8_t> FaceBaker::seenAround(std::span<const Origin> origins, std::span<const Face> faces, const glm::mat3& frame,
                                           double start) const {
    const std::span<const glm::vec3> directions = tools_.lattice.directions();
    double all = 0;
    for (const Origin& origin : origins) all += origin.weight;
    // Each origin gets its share of directions that spread over the whole hemisphere.
    std::vector<std::vector<size_t>> shares(origins.size());
    for (size_t k = 0; k < directions.size(); ++k) {
        double left = std::fmod(start + 0.6180339887498949 * double(k), 1.0) * all;
        size_t o = 0;
        while (o + 1 < origins.size() && left >= origins[o].weight) left -= origins[o++].weight;
        shares[o].push_back(k);
    }
    std::vector<uint8_t> blocked(directions.size()), some(directions.size());
    std::vector<glm::vec3> turned;
    for (size_t o = 0; o < shares.size(); ++o) {
        if (shares[o].empty()) continue;
        turned.clear();
        for (const size_t k : shares[o]) turned.push_back(frame * directions[k]);
        const Face& face = faces[origins[o].face];
        source_.occluded(prober_.pointAt(face.instance, face.triangle, face.probes[origins[o].probe].weights), turned, some.data());
        for (size_t n = 0; n < turned.size(); ++n) blocked[shares[o][n]] = some[n];
    }
    return blocked;
}

size_t FaceBaker::bake(size_t instance, std::span<const Face> faces, const Unknowns& unknowns, SeenOnFaces& seen,
                       ProgressCounter& counter) const {
    const std::span<const glm::vec3> directions = tools_.lattice.directions();
    const double straight = std::max(kStraight, kNoise * raysError(int(directions.size())).area);
    std::atomic<size_t> traced = 0;
    const Sites sites(unknowns, faces, seen);
    std::vector<BakedPoint> baked(sites.all.size());
    const bool agreeing = recipe_.model >= 0 && canAgree(models()[size_t(recipe_.model)]);
    std::vector<FittedPoint> fitted(agreeing ? baked.size() : 0);
    tbb::parallel_for(tbb::blocked_range<size_t>(0, baked.size(), 8), [&](const tbb::blocked_range<size_t>& range) {
        for (size_t s = range.begin(); s < range.end() && !counter.stopped(); ++s) {
            const Site& site = sites.all[s];
            const double start = hashUnit(options_.seed, instance << 40 | s, 3);
            const Face& face = faces[site.face];
            const int steps = aperturaLatticeSteps(face.level);
            const glm::vec3 at = glm::mix(latticePoint(site.sample, steps), glm::vec3(1 / 3.0f), kInside / float(steps));
            const SurfacePoint point = prober_.pointAt(face.instance, face.triangle, at);
            const glm::mat3 frame = frameFromZ(point.normal, 2 * std::numbers::pi * start);
            const Visibility& fitted4 = seen.visibility[seen.first[face.triangle] + size_t(site.sample)];
            std::vector<uint8_t> blocked = seenFrom(point, frame);
            traced += directions.size();
            if (!site.origins.empty() && difference(Samples(tools_.lattice, blocked), frame, fitted4) > straight) {
                blocked = seenAround(site.origins, faces, frame, start);
                traced += directions.size();
            }
            Samples samples(tools_.lattice, blocked);
            samples.source = &source_;
            samples.point = &point;
            baked[s] = makePoint(recipe_, tools_, samples, frame, fitOptions_);
            if (agreeing) fitted[s] = {baked[s], frame, samples.bits};
            counter.add(1);
        }
    });
    counter.throwIfStopped();
    if (agreeing) {
        const auto report = [&counter, done = size_t(0), all = fitted.size()](double share) mutable {
            const auto now = size_t(share * double(all));
            counter.add(now - done);
            done = now;
            return !counter.stopped();
        };
        agree(models()[size_t(recipe_.model)], tools_, fitOptions_, fitted, sites.neighbours(faces, seen), options_.seed, report);
        const glm::mat3 toLocal = glm::transpose(rotationPart(prober_.scene().instances[instance].toWorld));
        tbb::parallel_for(size_t(0), baked.size(), [&](size_t s) {
            baked[s] = fitted[s].baked;
            baked[s].params = roundedParams(models()[size_t(recipe_.model)], baked[s].params, fitted[s].frame[2], toLocal, options_.bits);
        });
    }
    if (recipe_.model >= 0) seen.allParams.resize(seen.visibility.size());
    for (size_t n = 0; n < seen.visibility.size(); ++n) {
        const BakedPoint& b = baked[sites.ofSample[n]];
        // A stored model leaves the four numbers as they are; those of `auto` belong to its choice.
        if (recipe_.model < 0 || recipe_.model == APERTURA_MODEL_AUTO) seen.visibility[n] = b.visibility;
        if (recipe_.model >= 0) seen.allParams[n] = b.params;
    }
    return traced;
}

}  // namespace apertura
