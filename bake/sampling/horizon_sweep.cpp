#define APERTURA_LANES plain
#include "apertura/bake/sampling/horizon_sweep.inc"

namespace apertura {

#ifdef APERTURA_AVX2
namespace avx2 {
void sweepLines(SweepField& field, const SweepDirection& direction, int first, int end, const SweepHorizons& keep);
}  // namespace avx2
#endif

int sweepGroups(const SweepField& field, const SweepDirection& direction) {
    const int lines = field.across + int(std::ceil(std::abs(direction.shift) * (field.along - 1))) + 1;
    return (lines + kSweepLines - 2) / (kSweepLines - 1);
}

void sweepLines(SweepField& field, const SweepDirection& direction, int first, int end, const SweepHorizons& keep) {
#ifdef APERTURA_AVX2
    static const bool wide = __builtin_cpu_supports("avx2");
    if (wide) return avx2::sweepLines(field, direction, first, end, keep);
#endif
    plain::sweepLines(field, direction, first, end, keep);
}

}  // namespace apertura
