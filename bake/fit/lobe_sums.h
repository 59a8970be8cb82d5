#pragma once
// The sums over samples that one step of fitting needs: the innermost loop of the bake.

namespace apertura {

// The samples of one point as SampleLattice lays them out.
struct PatchedSamples {
    const float* feature[9];  // SampleLattice::kFeatures
    const float* open;        // 0 or 1
    int blocks;               // of SampleLattice::kLanes patches side by side
    int patchSize;            // samples a patch
    int group;                // consecutive patches that make a large one, > 0
    float groupWeight;        // of the squared error of a large patch, by area, against that of a patch
    bool complement;          // the product is what is blocked
    static constexpr int kMaxBlocks = 64;
};

// The visibility is the product of K lobes, of which the first 2 L are taken in pairs, as what the pair leaves of 1.
// K lobes of M parameters each: the offset and what multiplies features 1 .. M - 1. Their derivatives are by
// the parameters themselves (Hard false) or by the offset and the slope's two tangents (Hard true).
template <int K, int M, bool Hard>
struct LobeSums {
    static constexpr int kColumns = Hard ? 3 : M, N = K * kColumns;
    // Of the residuals' derivatives, column by column, and in the last of the residuals themselves: the lower
    // half of all products, over patches and large ones; and the sums over patches. A residual is the sum of
    // cos (V - sample) over the patch. Without derivatives only the last are set.
    double products[N + 1][N + 1];
    double sums[N + 1];
};

// `parameters`: K * M. `tangents`: two vec3 a lobe where Hard, else not read. The bytes that come out do not
// depend on the processor: eight lanes, added up in the same order, on all of them.
template <int K, int M, bool Hard, int L>
void sumLobes(const PatchedSamples& samples, const float* parameters, const float* tangents, bool derivatives, LobeSums<K, M, Hard>& out);

// The same without what only newer processors have.
namespace plain {
template <int K, int M, bool Hard, int L>
void sumLobes(const PatchedSamples& samples, const float* parameters, const float* tangents, bool derivatives, LobeSums<K, M, Hard>& out);
}

// Those that there are: with APERTURA_INSTANCE(K, M, Hard, L) defined.
#define APERTURA_INSTANCES           \
    APERTURA_INSTANCE(1, 4, true, 0) \
    APERTURA_INSTANCE(2, 4, true, 0) \
    APERTURA_INSTANCE(3, 4, true, 0) \
    APERTURA_INSTANCE(3, 4, true, 1) \
    APERTURA_INSTANCE(4, 4, true, 0) \
    APERTURA_INSTANCE(4, 4, true, 1) \
    APERTURA_INSTANCE(4, 4, true, 2) APERTURA_INSTANCE(1, 4, false, 0) APERTURA_INSTANCE(2, 4, false, 0) APERTURA_INSTANCE(1, 9, false, 0)

}  // namespace apertura
