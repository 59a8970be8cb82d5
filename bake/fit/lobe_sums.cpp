#define APERTURA_LANES plain
#include "apertura/bake/fit/lobe_sums.inc"

namespace apertura {

#ifdef APERTURA_AVX2
namespace avx2 {
template <int K, int M, bool Hard, int L>
void sumLobes(const PatchedSamples& samples, const float* parameters, const float* tangents, bool derivatives, LobeSums<K, M, Hard>& out);
}  // namespace avx2
#endif

template <int K, int M, bool Hard, int L>
void sumLobes(const PatchedSamples& samples, const float* parameters, const float* tangents, bool derivatives, LobeSums<K, M, Hard>& out) {
#ifdef APERTURA_AVX2
    static const bool wide = __builtin_cpu_supports("avx2");
    if (wide) return avx2::sumLobes<K, M, Hard, L>(samples, parameters, tangents, derivatives, out);
#endif
    plain::sumLobes<K, M, Hard, L>(samples, parameters, tangents, derivatives, out);
}

#define APERTURA_INSTANCE(K, M, Hard, L) \
    template void sumLobes<K, M, Hard, L>(const PatchedSamples&, const float*, const float*, bool, LobeSums<K, M, Hard>&);
APERTURA_INSTANCES
#undef APERTURA_INSTANCE

}  // namespace apertura
