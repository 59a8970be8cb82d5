#define APERTURA_LANES avx2
#include "bake/fit/lobe_sums.inc"
