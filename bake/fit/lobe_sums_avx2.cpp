#define APERTURA_LANES avx2
#include "apertura/bake/fit/lobe_sums.inc"
