#pragma once
// The grid of the table behind toSoft, for its maker (make_soft_table.cpp) and its reader (soft.cpp).
namespace apertura::soft_grid {

// Coordinates, each 0..1 over its nodes: area acos(1 - 2 A/2 pi) / pi; psi / pi, the direction of
// (D_n - A/2, D_t); reach (1 - sqrt(1 - rho)) / kReach, rho being the distance as a share of the
// HardBoundary. The reach ends where the edge is as hard as float32 and filtering can use.
constexpr int kAreas = 28, kPsis = 80, kReaches = 32;
constexpr float kReach = 0.96f;
// The share of the hemisphere that counts as closed, and its complement as open.
constexpr float kLeastArea = 4e-5f;

// At each node, scaled so that neighbours differ little (x = A / 2 pi, L0 = softLinkInverse(x)):
struct Node {
    float sharpness;  // |slope| sqrt(1 - rho) sqrt(x (1 - x)) / rho
    float lean;       // the slope's angle from the normal less psi, radians
    float offset;     // offset / sqrt(1 + L0^2 + |slope|^2)
};

}  // namespace apertura::soft_grid
