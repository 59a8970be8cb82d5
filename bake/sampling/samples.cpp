#include "apertura/bake/sampling/samples.h"

#include <algorithm>
#include <bit>
#include <numbers>
#include <numeric>

#include "apertura/bake/sampling/directions.h"

namespace apertura {

SampleLattice::SampleLattice(int rays) : directions_(fibonacciHemisphere(rays)) {
    const size_t n = directions_.size();
    patchSize = int(std::bit_floor(std::max<size_t>(n / kPatches, 1)));
    const size_t blockSize = size_t(patchSize) * kLanes;
    blocks = int((n + blockSize - 1) / blockSize);
    // Whole groups, because orderInPatches makes only aligned runs neighbours.
    if (blocks > kGroup) blocks = (blocks + kGroup - 1) / kGroup * kGroup;
    for (auto& f : feature) f.assign(size_t(blocks) * blockSize, 0);
    for (size_t i = 0; i < n; ++i) {
        const size_t patch = i / size_t(patchSize), member = i % size_t(patchSize);
        const size_t at = (patch % size_t(blocks) * size_t(patchSize) + member) * kLanes + patch / size_t(blocks);
        place.push_back(int(at));
        const glm::vec3 w = directions_[i];
        const float values[kFeatures] = {
            1, w.x, w.y, w.z, w.x * w.x - w.z * w.z, w.y * w.y - w.z * w.z, 2 * w.x * w.y, 2 * w.x * w.z, 2 * w.y * w.z};
        for (int f = 0; f < kFeatures; ++f) feature[f][at] = values[f];
    }
    byHeight.resize(n);
    std::iota(byHeight.begin(), byHeight.end(), 0);
    std::stable_sort(byHeight.begin(), byHeight.end(), [&](int a, int b) { return directions_[size_t(a)].z > directions_[size_t(b)].z; });
    wordWeight.assign((n + 63) / 64, 0);
    allBits.assign(wordWeight.size(), 0);
    for (size_t i = 0; i < n; ++i) {
        const float z = directions_[size_t(byHeight[i])].z;
        wordWeight[i / 64] += z * z / float(std::min<size_t>(n - i / 64 * 64, 64));
        allBits[i / 64] |= uint64_t(1) << i % 64;
    }
}

double SampleLattice::solidAngle() const { return 2 * std::numbers::pi / rays(); }

Samples::Samples(const SampleLattice& on, std::span<const uint8_t> blocked)
    : lattice(&on), open(on.feature[0].size()), bits(on.wordWeight.size()) {
    for (size_t i = 0; i < on.byHeight.size(); ++i) {
        const auto direction = size_t(on.byHeight[i]);
        if (blocked[direction]) continue;
        open[size_t(on.place[direction])] = 1;
        bits[i / 64] |= uint64_t(1) << i % 64;
    }
}

}  // namespace apertura
