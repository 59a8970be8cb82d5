#pragma once
// The directions that points are sampled in, and what the rays of one point found, laid out for fitting.
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace apertura {

// The directions, about +Z, that every point is sampled in, and the features of them that fitting reads.
class SampleLattice {
public:
    explicit SampleLattice(int rays);

    int rays() const { return int(directions_.size()); }
    double solidAngle() const;  // sr per direction
    // In the order of fibonacciHemisphere, which is good for packets of rays.
    std::span<const glm::vec3> directions() const { return directions_; }

    // Fits compare the model with the samples by patches of neighbouring directions, about 256 over the hemisphere: with
    // 4096 rays, a patch is as large as a light of 5 degrees. kLanes patches stand side by side, and each lane holds
    // `blocks` neighbouring patches: sample m of patch l blocks + b is at the place (b patchSize + m) kLanes + l. The
    // features are 1, x, y, z and the five products x2-z2, y2-z2, 2xy, 2xz, 2yz; all are 0 at places without a sample.
    static constexpr int kFeatures = 9, kLanes = 8, kPatches = 256;
    static constexpr int kGroup = 8;  // neighbouring patches of a lane, together as large as a light of about 15 degrees
    int patchSize = 1, blocks = 0;
    std::vector<float> feature[kFeatures];
    std::vector<int> place;  // the place of each of directions()

    // The directions by falling height, 64 to a word: the order of Samples::bits. allBits has the bits that stand for a
    // direction, wordWeight the mean of cos^2 in each word.
    std::vector<int> byHeight;
    std::vector<uint64_t> allBits;
    std::vector<float> wordWeight;

private:
    std::vector<glm::vec3> directions_;
};

// What so many rays add to what is stored, RMS over the receivers of the ten built-in scenes: both fall as the 3/4th power of their number,
// as the patterns are even and edges are lines. Single points err by up to six times as much.
struct RaysError {
    double area;       // of the hemisphere
    double direction;  // radians, where more than a tenth of the hemisphere is open
};
inline RaysError raysError(int rays) {
    const double each = std::pow(double(rays), -0.75);
    return {0.435 * each, 2.24 * each};
}

class OcclusionSource;  // bake/sampling/occlusion.h
struct SurfacePoint;    // bake/sampling/solids.h

// Visibility in each direction of a lattice.
struct Samples {
    const SampleLattice* lattice;
    // Where they come from, for fits that ask for other directions too: null for samples that were not taken by samplePoints.
    const OcclusionSource* source = nullptr;
    const SurfacePoint* point = nullptr;
    std::vector<float> open;     // 0 or 1, at the lattice's places
    std::vector<uint64_t> bits;  // 1 open; in the order of byHeight, 0 beyond the last

    Samples(const SampleLattice& on, std::span<const uint8_t> blocked);  // `blocked`: 1 or 0, in the order of directions()
    bool isOpen(size_t direction) const { return open[size_t(lattice->place[direction])] > 0; }
};

}  // namespace apertura
