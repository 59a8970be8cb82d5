#define APERTURA_LANES avx2
#include "apertura/bake/sampling/horizon_exact.inc"
