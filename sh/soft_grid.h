#pragma once
// The grid of the table behind toSoft, for its maker (make_soft_table.cpp) and its reader (soft.cpp).
namespace apertura::soft_grid {

// Coordinates, each 0..1 over its nodes and free of trigonometry (x = A / 2 pi):
//   area   sqrt(x) / (sqrt(x) + sqrt(1 - x))
//   psi    (1 - p) / 2 with p = n / (|n| + t), for the direction (n, t) of (D_n - A/2, D_t)
//   reach  (1 - sqrt(1 - rho)) / kReach, rho being its distance as a share of the HardBoundary. It ends
//          where the edge is as hard as float32 and filtering can use.
constexpr int kAreas = 26, kPsis = 72, kReaches = 26;
constexpr float kReach = 0.96f;
// The share of the hemisphere that counts as closed, and its complement as open.
constexpr float kLeastArea = 4e-5f;

// At each node, scaled so that neighbours differ little (L0 = softStepInverse(x)):
struct Node {
    float sharpness;  // |slope| sqrt(1 - rho) sqrt(x (1 - x)) / rho
    float lean;       // tan of half the angle from (n, t) to the slope
    float offset;     // offset / sqrt(1 + L0^2 + |slope|^2)
};

}  // namespace apertura::soft_grid
