#pragma once
// The sums over samples that one step of fitting needs: the innermost loop of the bake.

namespace apertura {

// The samples of one point as SampleLattice lays them out.
struct PatchedSamples {
    const float* feature[9];  // SampleLattice::kFeatures
    const float* open;        // 0 or 1
    int blocks;               // of SampleLattice::kLanes patches side by side; at most kMaxBlocks
    int patchSize;            // samples a patch
    int group;                // how many consecutive patches make a large one, > 0
    float groupWeight;        // weight of the squared error of a large patch, by area; that of a patch has 1
    bool complement;          // true: the product of the lobes is what is blocked
    static constexpr int kMaxBlocks = 64;
};

// The sums for a product of K lobes, of which the first 2 L form pairs; the factor of a pair is 1 - the product of its
// two lobes. A lobe has M parameters: the offset, and the coefficients of features 1 .. M - 1. Derivatives are with
// respect to these (Hard false) or to the offset and the slope's two tangents (Hard true).
template <int K, int M, bool Hard>
struct LobeSums {
    static constexpr int kColumns = Hard ? 3 : M, N = K * kColumns;
    // The residual of a patch is the sum of cos (V - sample) over it. Columns 0 .. N - 1 are the derivatives of the
    // residuals by each parameter, column N the residuals themselves.
    //   products  the products of every two columns over patches and large patches, the lower half
    //   sums      the sums of the columns over patches
    // Without derivatives only products[N][N] and sums[N] are set.
    double products[N + 1][N + 1];
    double sums[N + 1];
};

// `parameters`: K * M, lobe by lobe. `tangents`: two vec3 per lobe where Hard, else not read. The result is the same to
// the bit on all processors: eight lanes, added in the same order.
template <int K, int M, bool Hard, int L>
void sumLobes(const PatchedSamples& samples, const float* parameters, const float* tangents, bool derivatives, LobeSums<K, M, Hard>& out);

// The same, without instructions that only newer processors have.
namespace plain {
template <int K, int M, bool Hard, int L>
void sumLobes(const PatchedSamples& samples, const float* parameters, const float* tangents, bool derivatives, LobeSums<K, M, Hard>& out);
}

// All instances: uses APERTURA_INSTANCE(K, M, Hard, L), which must be defined, for each.
// clang-format off
#define APERTURA_INSTANCES \
    APERTURA_INSTANCE(1, 4, true, 0) APERTURA_INSTANCE(2, 4, true, 0) APERTURA_INSTANCE(3, 4, true, 0) APERTURA_INSTANCE(3, 4, true, 1) \
    APERTURA_INSTANCE(4, 4, true, 0) APERTURA_INSTANCE(4, 4, true, 1) APERTURA_INSTANCE(4, 4, true, 2) \
    APERTURA_INSTANCE(1, 4, false, 0) APERTURA_INSTANCE(2, 4, false, 0) APERTURA_INSTANCE(1, 9, false, 0)
// clang-format on

}  // namespace apertura
