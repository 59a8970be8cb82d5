#pragma once
// The grid of the table behind toSoft, for the program that makes it (make_soft_table.cpp) and its reader (soft.cpp).
namespace apertura::soft_grid {

// The coordinates of the nodes, each 0..1 and free of trigonometry. x = A / 2 pi, (n, t) = (D_n - A/2, D_t):
//   area   sqrt(x) / (sqrt(x) + sqrt(1 - x))
//   psi    (1 - p) / 2 with p = n / (|n| + t)
//   reach  (1 - sqrt(1 - rho)) / kReach, where rho is |(n, t)| as a fraction of the HardBoundary. kReach ends the table
//          where the edge is as hard as float32 and filtering can use
constexpr int kAreas = 26, kPsis = 72, kReaches = 26;
constexpr float kReach = 0.96f;
// x is clamped to kLeastArea .. 1 - kLeastArea: a smaller opening counts as this one, a larger one as its complement.
constexpr float kLeastArea = 4e-5f;

// The values at a node, scaled so that neighbours differ little. L0 = softStepInverse(x).
struct Node {
    float sharpness;  // |slope| sqrt(1 - rho) sqrt(x (1 - x)) / rho
    float lean;       // tan of half the angle from (n, t) to the slope
    float offset;     // offset / sqrt(1 + L0^2 + |slope|^2)
};

}  // namespace apertura::soft_grid
