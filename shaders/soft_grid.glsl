// The grid of the table from which a soft aperture is made. GLSL and C++ include this text, sh/make_soft_table.cpp too.
#ifndef APERTURA_SOFT_GRID_GLSL
#define APERTURA_SOFT_GRID_GLSL

// The coordinates of the nodes, each 0..1 and free of trigonometry. x = A / 2 pi, (n, t) = (D_n - A/2, D_t):
//   area   sqrt(x) / (sqrt(x) + sqrt(1 - x))
//   psi    (1 - p) / 2 with p = n / (|n| + t)
//   reach  (1 - sqrt(1 - rho)) / APERTURA_SOFT_REACH, where rho is |(n, t)| as a fraction of the HardBoundary (sh/soft_solve.h).
//   APERTURA_SOFT_REACH ends
//          the table where the edge is as hard as float32 and filtering can use
const int APERTURA_SOFT_AREAS = 26;
const int APERTURA_SOFT_PSIS = 72;
const int APERTURA_SOFT_REACHES = 26;
const float APERTURA_SOFT_REACH = 0.96f;
// x is clamped to APERTURA_SOFT_LEAST_AREA .. 1 - APERTURA_SOFT_LEAST_AREA: a smaller opening counts as this one, a larger one as its
// complement.
const float APERTURA_SOFT_LEAST_AREA = 4e-5f;

// A node has four numbers, scaled so that neighbours differ little; L0 = softStepInverse(x). Nodes lie by area, psi and reach.
//   x  sharpness: |slope| sqrt(1 - rho) sqrt(x (1 - x)) / rho
//   y  lean: tan of half the angle from (n, t) to the slope
//   z  offset / sqrt(1 + L0^2 + |slope|^2)
//   w  the HardBoundary, the same for every reach

#endif
