#define APERTURA_LANES avx2
#include "bake/lobe_sums.inc"
