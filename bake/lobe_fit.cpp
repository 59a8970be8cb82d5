#include "bake/lobe_fit.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <experimental/simd>
#include <numbers>
#include <numeric>

namespace apertura {
namespace {

namespace stdx = std::experimental;
using Floats = stdx::native_simd<float>;
static_assert(SampleLattice::kLanes % Floats::size() == 0);

// The sharpest that an edge is made: harder than any mesh can show. Of a quadric, what its bytes can hold.
template <int M>
constexpr float kSlopeLimit = M == 4 ? 500 : 60;
constexpr double kSlopeCost = 1e-10;  // keeps lobes that nothing in the samples bounds from running away

// Solves A x = b for symmetric positive definite A by Cholesky's method; false where it is not.
template <int N>
bool solve(std::array<std::array<double, N>, N> a, std::array<double, N>& b, int n) {
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j <= i; ++j) {
            double sum = a[i][j];
            for (int k = 0; k < j; ++k) sum -= a[i][k] * a[j][k];
            if (i == j) {
                if (!(sum > 1e-14)) return false;
                a[i][i] = std::sqrt(sum);
            } else {
                a[i][j] = sum / a[j][j];
            }
        }
    }
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < i; ++k) b[i] -= a[i][k] * b[k];
        b[i] /= a[i][i];
    }
    for (int i = n - 1; i >= 0; --i) {
        for (int k = i + 1; k < n; ++k) b[i] -= a[k][i] * b[k];
        b[i] /= a[i][i];
    }
    return true;
}

// K lobes of M parameters, each a coefficient of a feature.
template <int K, int M>
struct Fitter {
    static constexpr int N = K * M;
    using Parameters = std::array<float, N>;
    using Matrix = std::array<std::array<double, N>, N>;

    const SampleLattice& lattice;
    const float* open;
    bool inverse;
    const LobeFitOptions& options;

    struct Sums {
        double cost = 0, error = 0;
        std::array<double, N> gradient{};
        Matrix hessian{};  // Gauss and Newton's
    };

    // The residual of a patch is the mean of cos (V - samples) over it: what a small light there would be
    // off by.
    Sums evaluate(const Parameters& p, bool derivatives) const {
        constexpr int kPairs = N * (N + 1) / 2;
        Floats error = 0, sum = 0, gradient[N] = {}, rise[N] = {}, products[kPairs] = {};
        const int size = lattice.patchSize;
        for (size_t block = 0; block < lattice.feature[0].size(); block += size_t(size) * SampleLattice::kLanes)
            for (size_t lane = 0; lane < SampleLattice::kLanes; lane += Floats::size()) {
                Floats off = 0, slope[N] = {};
                for (int member = 0; member < size; ++member) {
                    const size_t at = block + size_t(member) * SampleLattice::kLanes + lane;
                    Floats feature[M], visible[K], steep[K];
                    for (int m = 1; m < M; ++m) feature[m].copy_from(&lattice.feature[m][at], stdx::element_aligned);
                    Floats target(&open[at], stdx::element_aligned);
                    if (inverse) target = 1 - target;
                    Floats all = 1;
                    for (int k = 0; k < K; ++k) {
                        Floats f = p[k * M];
                        for (int m = 1; m < M; ++m) f += p[k * M + m] * feature[m];
                        const Floats r = 1 / sqrt(1 + f * f);
                        visible[k] = 0.5f + 0.5f * f * r;
                        steep[k] = 0.5f * r * r * r;
                        all *= visible[k];
                    }
                    const Floats height = feature[3];
                    off += height * (all - target);
                    if (!derivatives) continue;
                    for (int k = 0; k < K; ++k) {
                        Floats pull = height * steep[k];
                        for (int l = 0; l < K; ++l)
                            if (l != k) pull *= visible[l];
                        slope[k * M] += pull;
                        for (int m = 1; m < M; ++m) slope[k * M + m] += pull * feature[m];
                    }
                }
                error += off * off;
                sum += off;
                if (!derivatives) continue;
                int pair = 0;
                for (int i = 0; i < N; ++i) {
                    gradient[i] += off * slope[i];
                    rise[i] += slope[i];
                    for (int j = 0; j <= i; ++j, ++pair) products[pair] += slope[i] * slope[j];
                }
            }
        // A patch of one sample has cos2's mean of 1/3 as its largest mean square.
        const double rays = lattice.rays(), scale = 3 / (rays * size);
        const double tilt = reduce(sum) / rays, pull = 3 * options.ambientWeight;
        Sums out;
        out.error = reduce(error) * scale;
        out.cost = out.error + pull * tilt * tilt;
        for (int i = 0; i < N; ++i)
            if (i % M != 0) out.cost += kSlopeCost * p[i] * p[i];
        if (!derivatives) return out;
        int pair = 0;
        std::array<double, N> lift;
        for (int i = 0; i < N; ++i) {
            lift[i] = reduce(rise[i]) / rays;
            out.gradient[i] = reduce(gradient[i]) * scale + pull * tilt * lift[i];
            for (int j = 0; j <= i; ++j, ++pair)
                out.hessian[i][j] = out.hessian[j][i] = reduce(products[pair]) * scale + pull * lift[i] * lift[j];
        }
        for (int i = 0; i < N; ++i)
            if (i % M != 0) {
                out.gradient[i] += kSlopeCost * p[i];
                out.hessian[i][i] += kSlopeCost;
            }
        return out;
    }

    // The step of the damped normal equations; with a firmness, of those in the spheres' tangents.
    bool step(const Sums& at, const Parameters& p, double damping, std::array<double, N>& out) const {
        // Columns of the tangent space: each lobe's offset, and its slope's two tangents or three axes.
        std::array<std::array<double, N>, N> basis{};
        int n = 0;
        for (int k = 0; k < K; ++k) {
            basis[n++][k * M] = 1;
            if (options.firmness > 0) {
                const glm::dvec3 b = glm::normalize(glm::dvec3(p[k * M + 1], p[k * M + 2], p[k * M + 3]));
                const glm::dvec3 u = glm::normalize(glm::cross(b, std::abs(b.z) < 0.7 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0)));
                for (const glm::dvec3& t : {u, glm::cross(b, u)}) {
                    for (int c = 0; c < 3; ++c) basis[n][k * M + 1 + c] = t[c];
                    ++n;
                }
            } else {
                for (int m = 1; m < M; ++m) basis[n++][k * M + m] = 1;
            }
        }
        Matrix a{};
        std::array<double, N> b{};
        if (n == N) {
            a = at.hessian;
            for (int i = 0; i < N; ++i) b[i] = -at.gradient[i];
        } else {
            for (int i = 0; i < n; ++i) {
                std::array<double, N> row{};
                for (int c = 0; c < N; ++c)
                    if (basis[i][c] != 0)
                        for (int d = 0; d < N; ++d) row[d] += basis[i][c] * at.hessian[c][d];
                for (int j = 0; j < n; ++j)
                    for (int d = 0; d < N; ++d) a[i][j] += row[d] * basis[j][d];
                for (int c = 0; c < N; ++c) b[i] -= basis[i][c] * at.gradient[c];
            }
        }
        for (int i = 0; i < n; ++i) a[i][i] += damping * a[i][i] + 1e-9;
        if (!solve<N>(a, b, n)) return false;
        out.fill(0);
        for (int i = 0; i < n; ++i)
            for (int c = 0; c < N; ++c) out[c] += basis[i][c] * b[i];
        return true;
    }

    void tidy(Parameters& p) const {
        for (int k = 0; k < K; ++k) {
            float squared = 0;
            for (int m = 1; m < M; ++m) squared += p[k * M + m] * p[k * M + m];
            float scale = std::min(1.0f, kSlopeLimit<M> / std::sqrt(std::max(squared, 1e-12f)));
            if (options.firmness > 0) scale = options.firmness / std::sqrt(std::max(squared, 1e-12f));
            for (int m = 1; m < M; ++m) p[k * M + m] *= scale;
            p[k * M] = std::clamp(options.firmness > 0 ? p[k * M] : p[k * M] * scale, -3 * kSlopeLimit<M>, 3 * kSlopeLimit<M>);
        }
    }

    // Levenberg and Marquardt from `p`.
    Sums descend(Parameters& p, int steps) const {
        tidy(p);
        Sums now = evaluate(p, true);
        double damping = 1e-2;
        for (int i = 0; i < steps; ++i) {
            std::array<double, N> move;
            if (!step(now, p, damping, move)) break;
            Parameters q = p;
            for (int k = 0; k < K; ++k) {
                // No further in one step than the lobe is long.
                double length = 0, moved = 0;
                for (int m = 0; m < M; ++m) length += double(p[k * M + m]) * p[k * M + m], moved += move[k * M + m] * move[k * M + m];
                const double scale = std::min(1.0, (4 + std::sqrt(length)) / std::sqrt(std::max(moved, 1e-30)));
                for (int m = 0; m < M; ++m) q[k * M + m] += float(scale * move[k * M + m]);
            }
            tidy(q);
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

    // The same, with a try at a much sharper edge for each lobe: the way there is long and flat.
    Sums run(Parameters& p, int steps) const {
        Sums now = descend(p, steps);
        if (options.firmness > 0) return now;
        bool sharpened = false;
        for (int k = 0; k < K; ++k)
            for (const float times : {2.0f, 5.0f}) {
                Parameters q = p;
                for (int m = 0; m < M; ++m) q[k * M + m] *= times;
                tidy(q);
                if (const Sums there = evaluate(q, false); there.cost < now.cost) {
                    now.cost = there.cost;
                    p = q;
                    sharpened = true;
                }
            }
        return sharpened ? descend(p, steps) : evaluate(p, false);
    }
};

using Arrangement = std::vector<CapDictionary::Cap>;  // caps whose intersection is meant

// What blocks (for an inverse fit, what is open) as `count` clusters, weighed by the cosine, and the caps that
// leave each of them out. The cluster that spreads most is split across its longest axis, and all are
// settled by Lloyd's iteration.
Arrangement leaveOutClusters(const Samples& samples, bool inverse, int count) {
    const SampleLattice& lattice = *samples.lattice;
    std::vector<glm::vec3> at;
    std::vector<float> weight;
    for (size_t i = 0; i < lattice.directions().size(); ++i)
        if (samples.isOpen(i) == inverse) {
            at.push_back(lattice.directions()[i]);
            weight.push_back(at.back().z);
        }
    if (at.empty()) return Arrangement(size_t(count), {{0, 0, 1}, -1.2f});
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
        glm::vec3 axis(0.5f, 0.62f, 0.6f);
        for (int n = 0; n < 12; ++n) {
            const glm::vec3 next = spread[widest] * axis;
            if (!(glm::length(next) > 1e-12f)) break;
            axis = glm::normalize(next);
        }
        for (size_t i = 0; i < at.size(); ++i)
            if (size_t(owner[i]) == widest && glm::dot(axis, at[i] - centre[widest]) > 0) owner[i] = int(centre.size());
        centre.push_back(centre[widest]);
        settle(4);
    }
    std::vector<int> members(centre.size(), 0);
    for (int o : owner) ++members[size_t(o)];
    Arrangement out;
    for (size_t c = 0; c < centre.size(); ++c)
        out.push_back({-centre[c], float(members[c]) / float(lattice.rays()) - 1});  // 1 - area / 2 pi, of the complement
    return out;
}

template <int K>
LobeFit fitCount(const Samples& samples, const CapDictionary& dictionary, LobeFitSides sides, const LobeFitOptions& options) {
    using F = Fitter<K, 4>;
    // A few steps from each start; the best goes on to the end.
    const float firmness = options.firmness > 0 ? options.firmness : 6;
    typename F::Parameters best{};
    double least = 1e30;
    bool inverse = false;
    for (const bool side : {false, true}) {
        if (sides != LobeFitSides::Both && side != (sides == LobeFitSides::Inverse)) continue;
        std::vector<uint64_t> bits = samples.bits;
        if (side)
            for (size_t w = 0; w < bits.size(); ++w) bits[w] = ~bits[w] & samples.lattice->allBits[w];
        std::vector<Arrangement> starts{leaveOutClusters(samples, side, K)};
        for (const std::vector<int>& found : dictionary.nearest(bits, K, options.starts)) {
            Arrangement& caps = starts.emplace_back();
            for (int c : found) caps.push_back(dictionary.cap(size_t(c)));
        }
        const F fitter{*samples.lattice, samples.open.data(), side, options};
        for (const Arrangement& start : starts) {
            typename F::Parameters p;
            for (int k = 0; k < K; ++k) {
                const CapDictionary::Cap& cap = start[size_t(k)];
                p[k * 4] = -firmness * cap.cosine;
                for (int c = 0; c < 3; ++c) p[k * 4 + 1 + c] = firmness * cap.axis[c];
            }
            const double cost = fitter.descend(p, std::min(options.firstSteps, options.steps)).cost;
            if (cost < least) least = cost, best = p, inverse = side;
        }
    }
    LobeFit out;
    const F fitter{*samples.lattice, samples.open.data(), inverse, options};
    out.error = fitter.run(best, options.steps).error;
    if (options.firmness > 0 && options.hardened > options.firmness) {
        LobeFitOptions harder = options;
        harder.firmness = options.hardened;
        out.error = F{*samples.lattice, samples.open.data(), inverse, harder}.run(best, options.steps).error;
    }
    out.count = K;
    out.inverse = inverse;
    for (int k = 0; k < K; ++k) out.lobes[k] = {best[k * 4 + 1], best[k * 4 + 2], best[k * 4 + 3], best[k * 4]};
    return out;
}

}  // namespace

CapDictionary::CapDictionary(const SampleLattice& lattice, int axes, int heights)
    : wordWeight_(lattice.wordWeight), words_(lattice.wordWeight.size()) {
    // Everything, for lobes that have nothing left to do.
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

// Of `count` masks, each with `under`: the weighted samples of `bits` that it leaves out, and those that it
// holds too many, the latter times `mendable`.
void mismatches(const uint64_t* masks, size_t count, size_t words, const uint64_t* under, const uint64_t* bits, const float* weights,
                float mendable, float* out) {
    for (size_t c = 0; c < count; ++c) {
        float cost = 0;
        for (size_t w = 0; w < words; ++w) {
            const uint64_t mask = under[w] & masks[c * words + w];
            cost += weights[w] * (float(std::popcount(bits[w] & ~mask)) + mendable * float(std::popcount(mask & ~bits[w])));
        }
        out[c] = cost;
    }
}

#if defined(__x86_64__) && defined(__GNUC__)
// The same result by an instruction that the oldest of these processors lack.
[[gnu::target("popcnt")]] void mismatchesFast(const uint64_t* masks, size_t count, size_t words, const uint64_t* under, const uint64_t* bits,
                                              const float* weights, float mendable, float* out) {
    for (size_t c = 0; c < count; ++c) {
        float cost = 0;
        for (size_t w = 0; w < words; ++w) {
            const uint64_t mask = under[w] & masks[c * words + w];
            cost += weights[w] * (float(__builtin_popcountll(bits[w] & ~mask)) + mendable * float(__builtin_popcountll(mask & ~bits[w])));
        }
        out[c] = cost;
    }
}
#endif

}  // namespace

std::vector<std::vector<int>> CapDictionary::nearest(const std::vector<uint64_t>& bits, int count, int wanted) const {
    struct Start {
        float cost;
        std::vector<int> caps;
        std::vector<uint64_t> mask;
    };
    std::vector<std::vector<int>> out;
    if (wanted <= 0) return out;
    // Beams of partial arrangements. A first cap that leaves open what is blocked can be mended by those
    // after it, one that blocks what is open cannot: `mendable` is the share of the former that counts.
    std::vector<Start> beam{{0, {}, std::vector<uint64_t>(words_, ~uint64_t(0))}};
    std::vector<float> costs(caps_.size());
    for (int k = 0; k < count; ++k) {
        const float mendable = k == count - 1 ? 1.0f : 0.4f;
        struct Grown {
            float cost;
            size_t from, cap;
        };
        std::vector<Grown> grown;
        for (size_t from = 0; from < beam.size(); ++from) {
            countMismatches(beam[from].mask.data(), bits.data(), mendable, costs.data());
            for (size_t c = 0; c < caps_.size(); ++c) {
                if (grown.size() == size_t(wanted) && costs[c] >= grown.back().cost) continue;
                const auto at = std::upper_bound(grown.begin(), grown.end(), costs[c], [](float x, const Grown& g) { return x < g.cost; });
                grown.insert(at, {costs[c], from, c});
                if (grown.size() > size_t(wanted)) grown.pop_back();
            }
        }
        std::vector<Start> next;
        for (const Grown& g : grown) {
            Start s{g.cost, beam[g.from].caps, beam[g.from].mask};
            s.caps.push_back(int(g.cap));
            for (size_t w = 0; w < words_; ++w) s.mask[w] &= masks_[g.cap * words_ + w];
            next.push_back(std::move(s));
        }
        beam = std::move(next);
    }
    for (const Start& s : beam) out.push_back(s.caps);
    return out;
}

void CapDictionary::countMismatches(const uint64_t* under, const uint64_t* bits, float mendable, float* out) const {
#if defined(__x86_64__) && defined(__GNUC__)
    if (__builtin_cpu_supports("popcnt")) {
        mismatchesFast(masks_.data(), caps_.size(), words_, under, bits, wordWeight_.data(), mendable, out);
        return;
    }
#endif
    mismatches(masks_.data(), caps_.size(), words_, under, bits, wordWeight_.data(), mendable, out);
}

LobeFit fitLobes(const Samples& samples, const CapDictionary& dictionary, LobeFitSides sides, const LobeFitOptions& options) {
    switch (options.lobes) {
        case 1: return fitCount<1>(samples, dictionary, sides, options);
        case 2: return fitCount<2>(samples, dictionary, sides, options);
        case 3: return fitCount<3>(samples, dictionary, sides, options);
        default: return fitCount<4>(samples, dictionary, sides, options);
    }
}

LobeFit improveLobe(const Samples& samples, const glm::vec4& start, const LobeFitOptions& options) {
    using F = Fitter<1, 4>;
    typename F::Parameters p{start.w, start.x, start.y, start.z};
    LobeFit out;
    out.error = F{*samples.lattice, samples.open.data(), false, options}.run(p, options.steps).error;
    out.count = 1;
    out.lobes[0] = {p[1], p[2], p[3], p[0]};
    return out;
}

QuadricFit fitQuadric(const Samples& samples, const glm::vec4& start, const LobeFitOptions& options) {
    using F = Fitter<1, 9>;
    typename F::Parameters p{start.w, start.x, start.y, start.z};
    QuadricFit out;
    out.error = F{*samples.lattice, samples.open.data(), false, options}.run(p, options.steps).error;
    out.lobe = {p[1], p[2], p[3], p[0]};
    for (int i = 0; i < 5; ++i) out.bend[i] = p[size_t(4 + i)];
    return out;
}

}  // namespace apertura
