#include "apertura/bake/fit/lobe_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>

#include "apertura/bake/fit/lobe_sums.h"
#include "apertura/sh/shading.h"

namespace apertura {
namespace {

// The longest slope that is fitted: harder than any mesh can show. For a quadric, slope and bend that its bytes can hold.
template <int M>
constexpr float kSlopeLimit = M == 4 ? 500 : 60;
constexpr float kFirstSharpness = 30;  // of lobes and caps while starts are compared, before their edges become hard
constexpr double kSlopeCost = 1e-10;   // keeps lobes that no sample bounds from growing without end

// One column per lobe: its offset, then its slope and, of a quadric, its bend.
template <typename T, int M, int K>
using Lobes = Eigen::Matrix<T, M, K>;

// Fits K lobes of M parameters, each the coefficient of a feature. Hard: slopes have a given length. L: number of pairs,
// as in sumLobes.
template <int K, int M, bool Hard, int L>
struct Fitter {
    static constexpr int kColumns = LobeSums<K, M, Hard>::kColumns, kFree = K * kColumns;
    using Parameters = Lobes<float, M, K>;
    using Vector = Eigen::Matrix<double, kFree, 1>;
    using Matrix = Eigen::Matrix<double, kFree, kFree>;

    const SampleLattice& lattice;
    const float* open;
    bool complement;
    const LobeFitOptions& options;

    struct Sums {
        double cost = 0, error = 0;
        Vector gradient;
        Matrix hessian;  // Gauss–Newton, the lower half
        glm::vec3 tangents[2 * K];
    };

    // The residual of a patch is the sum of cos (V - samples) over it: the error for a small light there.
    Sums evaluate(const Parameters& p, bool derivatives) const {
        PatchedSamples samples{{}, open, lattice.blocks, lattice.patchSize, SampleLattice::kGroup, options.groupWeight, complement};
        for (int f = 0; f < SampleLattice::kFeatures; ++f) samples.feature[f] = lattice.feature[f].data();
        Sums out;
        if constexpr (Hard)
            for (int k = 0; k < K; ++k) {
                const glm::vec3 axis = glm::normalize(glm::vec3(p(1, k), p(2, k), p(3, k)));
                out.tangents[2 * k] = aperturaTangentTo(axis);
                out.tangents[2 * k + 1] = glm::cross(axis, out.tangents[2 * k]);
            }
        LobeSums<K, M, Hard> sums;
        sumLobes<K, M, Hard, L>(samples, p.data(), &out.tangents[0].x, derivatives, sums);
        // The unit is the largest mean square that patches of one sample can have: the mean of cos^2, 1/3.
        const double rays = lattice.rays(), scale = 3 / (rays * lattice.patchSize), pull = 3 * options.ambientWeight / (rays * rays);
        const double tilt = sums.sums[kFree];
        out.error = sums.products[kFree][kFree] * scale;
        out.cost = out.error + pull * tilt * tilt;
        const auto slopes = p.template bottomRows<M - 1>().template cast<double>();
        if (!Hard) out.cost += kSlopeCost * slopes.squaredNorm();
        if (!derivatives) return out;
        for (int i = 0; i < kFree; ++i) {
            out.gradient[i] = sums.products[kFree][i] * scale + pull * tilt * sums.sums[i];
            for (int j = 0; j <= i; ++j) out.hessian(i, j) = sums.products[i][j] * scale + pull * sums.sums[i] * sums.sums[j];
        }
        if constexpr (!Hard) {
            out.gradient.reshaped(Eigen::fix<M>, Eigen::fix<K>).template bottomRows<M - 1>() += kSlopeCost * slopes;
            for (int i = 0; i < kFree; ++i)
                if (i % M != 0) out.hessian(i, i) += kSlopeCost;
        }
        return out;
    }

    // The step that solves the damped normal equations (Cholesky). False where they are not positive definite.
    bool step(const Sums& at, double damping, Lobes<double, M, K>& out) const {
        Matrix a = at.hessian;
        a.diagonal().array() += damping * a.diagonal().array() + 1e-9;
        const Eigen::LLT<Matrix> factors(a);
        if (factors.info() != Eigen::Success) return false;
        const Vector b = factors.solve(-at.gradient);
        if constexpr (Hard) {
            for (int k = 0; k < K; ++k) {
                const Eigen::Map<const Eigen::Matrix<float, 3, 2>> tangents(&at.tangents[2 * k].x);
                out.col(k) << b[k * 3], tangents.template cast<double>() * b.template segment<2>(k * 3 + 1);
            }
        } else {
            out = b.reshaped(Eigen::fix<M>, Eigen::fix<K>);
        }
        return true;
    }

    void normalise(Parameters& p) const {
        for (auto lobe : p.colwise()) {
            const float length = std::max(lobe.template tail<M - 1>().norm(), 1e-6f);
            lobe *= Hard ? options.sharpness / length : std::min(1.0f, kSlopeLimit<M> / length);
            lobe[0] = std::clamp(lobe[0], -3 * kSlopeLimit<M>, 3 * kSlopeLimit<M>);
        }
    }

    // Levenberg–Marquardt from `p`.
    Sums descend(Parameters& p, int steps) const {
        normalise(p);
        Sums now = evaluate(p, true);
        double damping = 1e-2;
        for (int i = 0; i < steps; ++i) {
            Lobes<double, M, K> move;
            if (!step(now, damping, move)) break;
            Parameters q = p;
            for (int k = 0; k < K; ++k) {
                // A step is no longer than the lobe (slope and offset) plus 4.
                const double length = p.col(k).template cast<double>().norm(), moved = move.col(k).norm();
                const double scale = std::min(1.0, (4 + length) / std::max(moved, 1e-15));
                q.col(k) += (scale * move.col(k)).template cast<float>();
            }
            normalise(q);
            const Sums next = evaluate(q, true);
            if (next.cost < now.cost) {
                const bool done = next.cost > now.cost * (1 - 1e-4);
                p = q;
                now = next;
                damping = std::max(damping * 0.2, 1e-7);
                if (done) break;
            } else {
                damping = std::max(damping * 6, 1e-4);
                if (damping > 1e5) break;
            }
        }
        return now;
    }

    // descend, with a try at an edge 2 and 5 times as sharp for each lobe: the way there by small steps is long and flat.
    Sums run(Parameters& p, int steps) const {
        Sums now = descend(p, steps);
        if constexpr (Hard) return now;
        bool sharpened = false;
        for (int k = 0; k < K; ++k)
            for (const float times : {2.0f, 5.0f}) {
                Parameters q = p;
                q.col(k) *= times;
                normalise(q);
                if (const Sums there = evaluate(q, false); there.cost < now.cost) {
                    now.cost = there.cost;
                    p = q;
                    sharpened = true;
                }
            }
        return sharpened ? descend(p, steps) : evaluate(p, false);
    }
};

using Arrangement = std::vector<CapDictionary::Cap>;  // several caps, of which the intersection is meant

struct Cluster {
    glm::vec3 centre;
    float share;       // fraction of all directions
    glm::mat3 spread;  // the mean of (w - centre) (w - centre)^T
};

// The blocked directions (for the complement, the open ones) as `count` clusters, weighted by the cosine. The cluster
// with the largest spread is split across its longest axis until there are enough; Lloyd's iteration moves all centres
// after each split.
std::vector<Cluster> clusters(const Samples& samples, bool complement, int count) {
    const SampleLattice& lattice = *samples.lattice;
    std::vector<glm::vec3> at;
    std::vector<float> weight;
    for (size_t i = 0; i < lattice.directions().size(); ++i)
        if (samples.isOpen(i) == complement) {
            at.push_back(lattice.directions()[i]);
            weight.push_back(at.back().z);
        }
    if (at.empty()) return std::vector<Cluster>(size_t(count), {{0, 0, -1}, 0.0f, glm::mat3(0)});
    std::vector<int> owner(at.size(), 0);
    std::vector<glm::vec3> centre(1, glm::vec3(0));
    auto settle = [&](int iterations) {
        for (int n = 0; n < iterations; ++n) {
            std::vector<glm::vec3> sum(centre.size(), glm::vec3(0));
            for (size_t i = 0; i < at.size(); ++i) sum[size_t(owner[i])] += weight[i] * at[i];
            for (size_t c = 0; c < centre.size(); ++c)
                if (glm::length(sum[c]) > 0) centre[c] = glm::normalize(sum[c]);
            for (size_t i = 0; i < at.size(); ++i)
                for (size_t c = 0; c < centre.size(); ++c)
                    if (glm::dot(centre[c], at[i]) > glm::dot(centre[size_t(owner[i])], at[i])) owner[i] = int(c);
        }
    };
    settle(1);
    for (int k = 1; k < count; ++k) {
        std::vector<glm::mat3> spread(centre.size(), glm::mat3(0));
        for (size_t i = 0; i < at.size(); ++i) {
            const glm::vec3 off = at[i] - centre[size_t(owner[i])];
            spread[size_t(owner[i])] += weight[i] * glm::outerProduct(off, off);
        }
        size_t widest = 0;
        auto size = [&](size_t c) { return spread[c][0][0] + spread[c][1][1] + spread[c][2][2]; };
        for (size_t c = 1; c < centre.size(); ++c)
            if (size(c) > size(widest)) widest = c;
        // The power method. Fits from Eigen's exact axis end at 0.998 to 1.000 of the error, one of them where multi-2 steps.
        glm::vec3 axis(0.5f, 0.62f, 0.6f);
        for (int n = 0; n < 12; ++n) {
            const glm::vec3 next = spread[widest] * axis;
            if (!(glm::length(next) > 1e-12f)) break;
            axis = glm::normalize(next);
        }
        for (size_t i = 0; i < at.size(); ++i)
            if (size_t(owner[i]) == widest && glm::dot(axis, at[i] - centre[widest]) > 0) owner[i] = int(centre.size());
        centre.push_back(centre[widest]);
        settle(2);
    }
    std::vector<Cluster> out;
    out.reserve(centre.size());
    for (const glm::vec3& c : centre) out.push_back({c, 0, glm::mat3(0)});
    for (size_t i = 0; i < at.size(); ++i) {
        Cluster& c = out[size_t(owner[i])];
        c.share += 1 / float(lattice.rays());
        c.spread += glm::outerProduct(at[i] - c.centre, at[i] - c.centre) / float(lattice.rays());
    }
    for (Cluster& c : out) c.spread /= std::max(c.share, 1e-6f);
    return out;
}

// The cap that excludes the cluster: all but a cap of its area about its centre.
CapDictionary::Cap capWithout(const Cluster& cluster) { return {-cluster.centre, cluster.share - 1}; }

// Two caps whose intersection holds the cluster: a lens with its tips on the longer axis.
std::array<CapDictionary::Cap, 2> lensAround(const Cluster& cluster) {
    const glm::vec3 c = cluster.centre, u = aperturaTangentTo(c), v = glm::cross(c, u);
    const float uv = glm::dot(u, cluster.spread * v);
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2f> ellipse;
    ellipse.computeDirect(Eigen::Matrix2f{{glm::dot(u, cluster.spread * u), uv}, {uv, glm::dot(v, cluster.spread * v)}});
    const Eigen::Vector2f deviations = ellipse.eigenvalues().cwiseMax(0).cwiseSqrt(), longer = ellipse.eigenvectors().col(1);
    const glm::vec3 along = longer.x() * u + longer.y() * v, across = glm::cross(c, along);
    // The half axes of a uniform ellipse are twice its standard deviations.
    const float length = std::clamp(2.2f * deviations[1], 0.05f, 1.4f), breadth = std::clamp(2 * deviations[0], 0.02f, 0.7f * length);
    const glm::vec3 tip = std::cos(length) * c + std::sin(length) * along, other = std::cos(length) * c - std::sin(length) * along;
    std::array<CapDictionary::Cap, 2> out;
    for (int side = 0; side < 2; ++side) {
        const glm::vec3 edge = std::cos(breadth) * c + (side ? 1.0f : -1.0f) * std::sin(breadth) * across;
        glm::vec3 axis = glm::normalize(glm::cross(other - tip, edge - tip));
        if (glm::dot(axis, c - edge) < 0) axis = -axis;
        out[size_t(side)] = {axis, glm::dot(axis, edge)};
    }
    return out;
}

// The best start so far, over all arrangements of K lobes.
template <int K>
struct Best {
    Lobes<float, 4, K> parameters = Lobes<float, 4, K>::Zero();
    double cost = 1e30;
    bool complement = false;
    int pairs = 0;
};

template <int K, bool Hard, int L>
void tryStarts(const Samples& samples, bool complement, const LobeFitOptions& options, std::span<const Arrangement> starts, Best<K>& best) {
    // Edges are as soft as samples are apart: harder ones would have no gradient to follow.
    LobeFitOptions hazy = options;
    if (Hard) hazy.sharpness = std::min(options.sharpness, kFirstSharpness);
    const float sharpness = Hard ? hazy.sharpness : 6;
    const Fitter<K, 4, Hard, L> fitter{*samples.lattice, samples.open.data(), complement, hazy};
    for (const Arrangement& start : starts) {
        Lobes<float, 4, K> p;
        for (int k = 0; k < K; ++k) {
            const CapDictionary::Cap& cap = start[size_t(k)];
            p.col(k) << -cap.cosine, cap.axis.x, cap.axis.y, cap.axis.z;
        }
        p *= sharpness;
        const double cost = fitter.descend(p, std::min(options.firstSteps, options.steps)).cost;
        if (cost < best.cost) best = {p, cost, complement, L};
    }
}

template <int K, bool Hard, int L>
double finish(const Samples& samples, const LobeFitOptions& options, Best<K>& best) {
    return Fitter<K, 4, Hard, L>{*samples.lattice, samples.open.data(), best.complement, options}.run(best.parameters, options.steps).error;
}

// One start for every choice of the clusters that pairs exclude.
template <int K, int L>
std::vector<Arrangement> pairedStarts(const Samples& samples, bool complement) {
    const std::vector<Cluster> found = clusters(samples, complement, K - L);
    std::vector<Arrangement> out;
    for (int paired = 0; paired < 1 << found.size(); ++paired) {
        if (std::popcount(unsigned(paired)) != L) continue;
        Arrangement& start = out.emplace_back();
        for (size_t c = 0; c < found.size(); ++c)
            if (paired >> c & 1)
                for (const CapDictionary::Cap& cap : lensAround(found[c])) start.push_back(cap);
        for (size_t c = 0; c < found.size(); ++c)
            if (!(paired >> c & 1)) start.push_back(capWithout(found[c]));
    }
    return out;
}

template <int K, bool Hard>
LobeFit fitCount(const Samples& samples, const CapDictionary& dictionary, LobeFitSides sides, const LobeFitOptions& options) {
    Best<K> best;
    for (const bool complement : {false, true}) {
        if (sides != LobeFitSides::Both && complement != (sides == LobeFitSides::Complement)) continue;
        std::vector<uint64_t> bits = samples.bits;
        if (complement)
            for (size_t w = 0; w < bits.size(); ++w) bits[w] = ~bits[w] & samples.lattice->allBits[w];
        std::vector<Arrangement> starts = pairedStarts<K, 0>(samples, complement);
        for (const std::vector<int>& found : dictionary.nearest(bits, K, options.starts)) {
            Arrangement& caps = starts.emplace_back();
            for (int c : found) caps.push_back(dictionary.cap(size_t(c)));
        }
        tryStarts<K, Hard, 0>(samples, complement, options, starts, best);
        if (!options.pairs) continue;
        if constexpr (Hard && K >= 3) tryStarts<K, Hard, 1>(samples, complement, options, pairedStarts<K, 1>(samples, complement), best);
        if constexpr (Hard && K >= 4) tryStarts<K, Hard, 2>(samples, complement, options, pairedStarts<K, 2>(samples, complement), best);
    }
    const auto finishOf = [&](const LobeFitOptions& how, Best<K>& from) {
        if constexpr (Hard && K >= 4)
            if (from.pairs == 2) return finish<K, Hard, 2>(samples, how, from);
        if constexpr (Hard && K >= 3)
            if (from.pairs == 1) return finish<K, Hard, 1>(samples, how, from);
        return finish<K, Hard, 0>(samples, how, from);
    };
    Best<K> softer = best;
    LobeFit out;
    out.error = finishOf(options, best);
    if (Hard && options.softer > 0) {
        LobeFitOptions how = options;
        how.sharpness = options.softer;
        if (const double error = finishOf(how, softer); error < out.error * (1 + options.softerShare)) {
            best = softer;
            out.error = error;
        }
    }
    out.count = K;
    out.complement = best.complement;
    out.pairs = best.pairs;
    const auto& p = best.parameters;
    for (int k = 0; k < K; ++k) out.lobes[k] = {p(1, k), p(2, k), p(3, k), p(0, k)};
    return out;
}

}  // namespace

CapDictionary::CapDictionary(const SampleLattice& lattice, int axes, int heights) : words_(lattice.wordWeight.size()) {
    for (float weight : lattice.wordWeight) wordWeight_.push_back(uint32_t(weight * 4096));
    // The whole sphere, for lobes that are not needed.
    caps_.push_back({{0, 0, 1}, -1.2f});
    masks_ = lattice.allBits;
    for (int a = 0; a < axes; ++a) {
        const double z = 1 - 2 * (a + 0.5) / axes, s = std::sqrt(1 - z * z), turn = a * std::numbers::pi * (3 - std::sqrt(5.0));
        const glm::vec3 axis(s * std::cos(turn), s * std::sin(turn), z);
        for (int h = 0; h < heights; ++h) {
            const float cosine = float(0.98 - 1.9 * h / (heights - 1));
            std::vector<uint64_t> mask(words_);
            int inside = 0;
            for (size_t i = 0; i < lattice.byHeight.size(); ++i)
                if (glm::dot(axis, lattice.directions()[size_t(lattice.byHeight[i])]) >= cosine) {
                    mask[i / 64] |= uint64_t(1) << i % 64;
                    ++inside;
                }
            if (inside == 0 || inside == lattice.rays()) continue;
            caps_.push_back({axis, cosine});
            masks_.insert(masks_.end(), mask.begin(), mask.end());
        }
    }
}

namespace {

// How well each mask, intersected with `under`, fits: hit * (weight of the samples in it that are in `bits`) - held *
// (weight of all samples in it).
struct MaskScores {
    std::span<const uint64_t> masks;
    std::span<const uint32_t> weights;  // of the words of each mask
    const uint64_t *under, *bits;
    int64_t hit, held;
};

// Words > 0: the number of words per mask, as a constant.
template <size_t Words = 0>
[[gnu::always_inline]] inline void score(const MaskScores& m, std::span<int64_t> out) {
    const size_t words = Words ? Words : m.weights.size();
    for (size_t c = 0; c < out.size(); ++c) {
        uint64_t hits = 0, all = 0;
        for (size_t w = 0; w < words; ++w) {
            const uint64_t mask = m.under[w] & m.masks[c * words + w];
            hits += m.weights[w] * uint64_t(std::popcount(mask & m.bits[w]));
            all += m.weights[w] * uint64_t(std::popcount(mask));
        }
        out[c] = m.hit * int64_t(hits) - m.held * int64_t(all);
    }
}

void scorePlainly(const MaskScores& m, std::span<int64_t> out) { score(m, out); }
#if defined(__x86_64__) && defined(__GNUC__)
// Uses the instruction popcnt, which the oldest x86-64 processors lack.
[[gnu::target("popcnt")]] void scoreFast(const MaskScores& m, std::span<int64_t> out) {
    m.weights.size() == 4 ? score<4>(m, out) : score(m, out);  // 4: of 256 rays
}
#endif

}  // namespace

std::vector<std::vector<int>> CapDictionary::nearest(const std::vector<uint64_t>& bits, int count, int wanted) const {
    struct Start {
        std::vector<int> caps;
        std::vector<uint64_t> mask;
    };
    std::vector<std::vector<int>> out;
    if (wanted <= 0) return out;
    // Beam search over partial arrangements. Where a cap leaves blocked directions open, later caps can block them; where
    // it blocks open ones, no later cap can help. So until the last cap, a direction wrongly left open costs only `held`
    // tenths of one wrongly blocked.
    std::vector<Start> beam{{{}, std::vector<uint64_t>(words_, ~uint64_t(0))}};
    std::vector<int64_t> scores(caps_.size());
    for (int k = 0; k < count; ++k) {
        const int held = k == count - 1 ? 10 : 4;
        struct Grown {
            int64_t score;
            size_t from, cap;
        };
        std::vector<Grown> grown;
        for (size_t from = 0; from < beam.size(); ++from) {
            const MaskScores how{masks_, wordWeight_, beam[from].mask.data(), bits.data(), 10 + held, held};
#if defined(__x86_64__) && defined(__GNUC__)
            static const bool fast = __builtin_cpu_supports("popcnt");
            (fast ? scoreFast : scorePlainly)(how, scores);
#else
            scorePlainly(how, scores);
#endif
            for (size_t c = 0; c < caps_.size(); ++c) {
                if (grown.size() == size_t(wanted) && scores[c] <= grown.back().score) continue;
                const auto at = std::upper_bound(grown.begin(), grown.end(), scores[c],
                                                 [](int64_t x, const Grown& g) { return x > g.score; });
                grown.insert(at, {scores[c], from, c});
                if (grown.size() > size_t(wanted)) grown.pop_back();
            }
        }
        std::vector<Start> next;
        for (const Grown& g : grown) {
            Start s{beam[g.from].caps, beam[g.from].mask};
            s.caps.push_back(int(g.cap));
            for (size_t w = 0; w < words_; ++w) s.mask[w] &= masks_[g.cap * words_ + w];
            next.push_back(std::move(s));
        }
        beam = std::move(next);
    }
    for (const Start& s : beam) out.push_back(s.caps);
    return out;
}

LobeFit fitLobes(const Samples& samples, const CapDictionary& dictionary, LobeFitSides sides, const LobeFitOptions& options) {
    assert(options.sharpness > 0 || options.lobes <= 2);
    const bool firm = options.sharpness > 0;
    switch (options.lobes) {
        case 1: return (firm ? fitCount<1, true> : fitCount<1, false>)(samples, dictionary, sides, options);
        case 2: return (firm ? fitCount<2, true> : fitCount<2, false>)(samples, dictionary, sides, options);
        case 3: return fitCount<3, true>(samples, dictionary, sides, options);
        default: return fitCount<4, true>(samples, dictionary, sides, options);
    }
}

namespace {

template <int K, bool Hard, int L = 0>
LobeFit improve(const Samples& samples, const LobeFit& start, const LobeFitOptions& options) {
    const Fitter<K, 4, Hard, L> fitter{*samples.lattice, samples.open.data(), start.complement, options};
    Lobes<float, 4, K> p;
    for (int k = 0; k < K; ++k) p.col(k) << start.lobes[k].w, start.lobes[k].x, start.lobes[k].y, start.lobes[k].z;
    LobeFit out = start;
    if (options.steps == 0) {
        out.error = fitter.evaluate(p, false).error;
        return out;
    }
    out.error = fitter.descend(p, options.steps).error;
    for (int k = 0; k < K; ++k) out.lobes[k] = {p(1, k), p(2, k), p(3, k), p(0, k)};
    return out;
}

}  // namespace

LobeFit improveLobes(const Samples& samples, const LobeFit& start, LobeFitOptions options) {
    const bool firm = options.sharpness > 0;
    if (firm) options.sharpness = std::max(glm::length(glm::vec3(start.lobes[0])), 1e-3f);
    switch (start.count) {
        case 1: return (firm ? improve<1, true> : improve<1, false>)(samples, start, options);
        case 2: return (firm ? improve<2, true> : improve<2, false>)(samples, start, options);
        case 3: return (start.pairs ? improve<3, true, 1> : improve<3, true>)(samples, start, options);
        default:
            return (start.pairs == 2   ? improve<4, true, 2>
                    : start.pairs == 1 ? improve<4, true, 1>
                                       : improve<4, true>)(samples, start, options);
    }
}

LobeFit improveLobe(const Samples& samples, const glm::vec4& start, const LobeFitOptions& options) {
    using F = Fitter<1, 4, false, 0>;
    F::Parameters p(start.w, start.x, start.y, start.z);
    LobeFit out;
    out.error = F{*samples.lattice, samples.open.data(), false, options}.run(p, options.steps).error;
    out.count = 1;
    out.lobes[0] = {p[1], p[2], p[3], p[0]};
    return out;
}

QuadricFit fitQuadric(const Samples& samples, const glm::vec4& start, const LobeFitOptions& options) {
    using F = Fitter<1, 9, false, 0>;
    F::Parameters p = F::Parameters::Zero();
    p.head<4>() << start.w, start.x, start.y, start.z;
    QuadricFit out;
    out.error = F{*samples.lattice, samples.open.data(), false, options}.run(p, options.steps).error;
    out.lobe = {p[1], p[2], p[3], p[0]};
    for (int i = 0; i < 5; ++i) out.bend[i] = p[size_t(4 + i)];
    return out;
}

}  // namespace apertura
