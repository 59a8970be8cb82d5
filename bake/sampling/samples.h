#pragma once
// What the rays of one point found, laid out for fitting.
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace apertura {

// The directions that every point is sampled in, about +Z, and what fitting reads of them.
class SampleLattice {
public:
    explicit SampleLattice(int rays);

    int rays() const { return int(directions_.size()); }
    double solidAngle() const;  // sr a direction
    // In the order of fibonacciHemisphere, for rays.
    std::span<const glm::vec3> directions() const { return directions_; }

    // Fits compare the model with the samples by patches of neighbours, about 256 of the hemisphere: of 4096
    // rays a patch is as large as a light of 5 degrees. kLanes of them stand side by side, each a lane of
    // `blocks` neighbours: sample m of patch l blocks + b stands at (b patchSize + m) kLanes + l. The features are 1, x, y, z and the five
    // products x2-z2, y2-z2, 2xy, 2xz, 2yz; all of them are 0 where a patch has no sample.
    static constexpr int kFeatures = 9, kLanes = 8, kPatches = 256;
    static constexpr int kGroup = 8;  // neighbouring patches of a lane, together a light of about 15 degrees
    int patchSize = 1, blocks = 0;
    std::vector<float> feature[kFeatures];
    std::vector<int> place;  // where each of directions() stands

    // By falling height, 64 at a time: the order of Samples::bits, what cos2 is on average in each word, and
    // the bits that stand for a direction.
    std::vector<int> byHeight;
    std::vector<uint64_t> allBits;
    std::vector<float> wordWeight;

private:
    std::vector<glm::vec3> directions_;
};

// Visibility in each direction of a lattice.
struct Samples {
    const SampleLattice* lattice;
    std::vector<float> open;     // 0 or 1, at the lattice's places
    std::vector<uint64_t> bits;  // by falling height; 0 beyond the last

    Samples(const SampleLattice& on, std::span<const uint8_t> blocked);  // in the order of directions()
    bool isOpen(size_t direction) const { return open[size_t(lattice->place[direction])] > 0; }
};

}  // namespace apertura
