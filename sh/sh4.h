#pragma once
// Four spherical-harmonics coefficients of visibility, and the area and direction that they stand for.
// Functions in this folder are total: any finite input gives a finite result. Nothing throws but models().
#include <glm/glm.hpp>
#include <span>

namespace apertura {

// What a receiver sees of the sphere of directions, in steradians: A = integral of V, D = integral of V w, where V is 1
// in open directions and 0 in blocked ones. A is in 0..2 pi; |D| <= A (1 - A / 4 pi), with equality exactly when the open
// region is a cap.
struct Visibility {
    glm::vec3 direction{0};  // D
    float area = 0;          // A, not cosine weighted
};

// Real orthonormal SH without Condon-Shortley sign, index l (l + 1) + m, so band 1 is (y, z, x).
// c[0] = A / (2 sqrt pi), c[1..3] = sqrt(3 / 4 pi) D: the same information as a Visibility.
struct Sh4 {
    float c[4]{};
};

// The four basis functions at the unit direction w.
Sh4 shBasis(const glm::vec3& w);

// The SH coefficients of visibility: the sum of the basis over the `open` directions (unit), each standing for
// `solidAngle` sr.
Sh4 project(std::span<const glm::vec3> open, double solidAngle);

Sh4 toSh4(const Visibility& v);
Visibility toVisibility(const Sh4& sh);

// |D| / (A (1 - A / 4 pi)), 0..1: how nearly the open region is a cap. 1 where nothing is open.
float capness(const Visibility& v);

// The nearest visibility that a region of the sphere can have: A is clamped to 0..2 pi, |D| to its bound. A value that is
// not finite becomes a closed point.
Visibility clampToPossible(Visibility v);

}  // namespace apertura
