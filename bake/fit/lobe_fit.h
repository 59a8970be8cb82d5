#pragma once
// Products of soft lobes fitted to the visibility that rays found.
#include <glm/glm.hpp>
#include <vector>

#include "bake/sampling/samples.h"

namespace apertura {

// V(w) = the product of softStep(offset + dot(slope, w)), or what that leaves of 1. See combineLobes in shaders/several.glsl.
struct LobeFit {
    glm::vec4 lobes[4]{};  // slope, offset, about +Z as the lattice
    int count = 0;
    bool complement = false;
    int pairs = 0;     // 0, 1 or 2: of the first lobes, two by two, the factor is what a pair leaves of 1
    double error = 0;  // mean square of cos (V - samples) over patches, and as much again over groups of them,
                       // in units of cos2's mean: 0 .. 1 + groupWeight
};

struct LobeFitOptions {
    int lobes = 1;            // 1 .. 4
    float sharpness = 0;      // > 0: the length of every slope; 0: free, of one or two lobes only
    bool pairs = false;       // of three or four lobes with a sharpness: LobeFit::pairs may be other than 0
    float ambientWeight = 0;  // of the squared error of the irradiance from an even sky
    int steps = 8;            // of Levenberg–Marquardt, at most,
    int firstSteps = 4;       // and from each start; the best goes on to the end
    float groupWeight = 1;    // of the squared error over groups of patches, as of larger lights, against that over patches
    int starts = 2;           // of the hard-edged arrangements tried first
};

// Caps of many axes and heights as masks over a lattice: where fits start from.
class CapDictionary {
public:
    CapDictionary(const SampleLattice& lattice, int axes, int heights);

    struct Cap {
        glm::vec3 axis;
        float cosine;
    };
    size_t size() const { return caps_.size(); }
    const Cap& cap(size_t i) const { return caps_[i]; }
    // Arrangements of `count` caps whose intersection is nearest to `bits`, best first, as indices.
    std::vector<std::vector<int>> nearest(const std::vector<uint64_t>& bits, int count, int wanted) const;

private:
    std::vector<Cap> caps_;
    std::vector<uint64_t> masks_;  // words_ a cap
    std::vector<uint32_t> wordWeight_;
    size_t words_;
};

// Whether the product itself is fitted, what it leaves, or the better of the two.
enum class LobeFitSides { Product, Complement, Both };

// Minimises that error. Deterministic.
LobeFit fitLobes(const Samples& samples, const CapDictionary& dictionary, LobeFitSides sides, const LobeFitOptions& options);

// One lobe, improved from `start`.
LobeFit improveLobe(const Samples& samples, const glm::vec4& start, const LobeFitOptions& options);

// softStep(offset + dot(slope, w) + w Q w), from `start`; `bend` as SoftQuadric's.
struct QuadricFit {
    glm::vec4 lobe;
    float bend[5];
    double error;
};
QuadricFit fitQuadric(const Samples& samples, const glm::vec4& start, const LobeFitOptions& options);

}  // namespace apertura
