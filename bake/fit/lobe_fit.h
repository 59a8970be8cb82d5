#pragma once
// Fits products of soft lobes to the visibility that rays found.
#include <glm/glm.hpp>
#include <vector>

#include "apertura/bake/sampling/samples.h"

namespace apertura {

// V(w) = the product of aperturaSoftStep(offset + dot(slope, w)), or 1 - that product. See aperturaCombineLobes in shaders/several.glsl.
struct LobeFit {
    glm::vec4 lobes[4]{};  // xyz: slope, w: offset, in the lattice's frame: the normal is +Z
    int count = 0;
    bool complement = false;
    int pairs = 0;  // 0, 1 or 2: how many pairs of lobes, from the first on, enter as 1 - their product
    // Mean square of cos (V - samples) over patches, plus groupWeight times that over groups of patches, both divided
    // by the mean of cos^2, 1/3: 0 .. 1 + groupWeight.
    double error = 0;
};

struct LobeFitOptions {
    int lobes = 1;            // 1 .. 4
    float sharpness = 0;      // > 0: the length of every slope; 0: lengths are free, for one or two lobes only
    float softer = 0;         // > 0: another length that every slope may have instead,
    float softerShare = 0;    // where the error is less than 1 + this times that of `sharpness`
    bool pairs = false;       // also try LobeFit::pairs, for three or four lobes with a sharpness
    float ambientWeight = 0;  // weight of the squared error of the irradiance from a uniform sky
    int steps = 8;            // Levenberg–Marquardt steps, at most,
    int firstSteps = 4;       // and those from each start, of which the best goes on to the end
    float groupWeight = 1;    // weight of the squared error over groups of patches, as of larger lights; that over patches has 1
    int starts = 2;           // how many starts are taken from the dictionary, beside those made from clusters
};

// Caps of many axes and heights as bit masks over a lattice, from which fits start.
class CapDictionary {
public:
    // `axes`: of a Fibonacci lattice over the sphere, 0 or more. `heights`: caps about each, 2 or more, with cosines of
    // the radius from 0.98 down to -0.92.
    CapDictionary(const SampleLattice& lattice, int axes, int heights);

    struct Cap {
        glm::vec3 axis;
        float cosine;  // of the radius; below -1: everything
    };
    size_t size() const { return caps_.size(); }
    const Cap& cap(size_t i) const { return caps_[i]; }
    // The `wanted` arrangements of `count` caps, as indices, whose intersection is nearest to `bits` (as Samples::bits),
    // best first, by beam search.
    std::vector<std::vector<int>> nearest(const std::vector<uint64_t>& bits, int count, int wanted) const;

private:
    std::vector<Cap> caps_;
    std::vector<uint64_t> masks_;  // words_ per cap
    std::vector<uint32_t> wordWeight_;
    size_t words_;
};

// Fit the product, its complement, or the better of the two.
enum class LobeFitSides { Product, Complement, Both };

// Minimises LobeFit::error plus the error of the sky that ambientWeight asks for. Deterministic.
LobeFit fitLobes(const Samples& samples, const CapDictionary& dictionary, LobeFitSides sides, const LobeFitOptions& options);

// Improves lobes from `start`, as they are combined there, by `options.steps`, each as sharp as the first of them if `options.sharpness`
// is above 0. With no steps only the error is set.
LobeFit improveLobes(const Samples& samples, const LobeFit& start, LobeFitOptions options);

// Improves one lobe of free sharpness from `start` (slope, offset).
LobeFit improveLobe(const Samples& samples, const glm::vec4& start, const LobeFitOptions& options);

// V(w) = aperturaSoftStep(offset + dot(slope, w) + w Q w), fitted from the lobe `start` (slope, offset). `bend`: Qxx, Qyy, Qxy,
// Qxz, Qyz, as in AperturaSoftQuadric.
struct QuadricFit {
    glm::vec4 lobe;
    float bend[5];
    double error;
};
QuadricFit fitQuadric(const Samples& samples, const glm::vec4& start, const LobeFitOptions& options);

}  // namespace apertura
