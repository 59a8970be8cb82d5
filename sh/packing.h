#pragma once
// The bytes of the asset's _VISIBILITY attribute: VEC4, normalised signed integers (glTF 2.0, 3.11),
// x, y, z = D / A, w = 2 sqrt(A / 2 pi) - 1. A closed point (A = 0) is 0, 0, 0, -1.
#include <array>
#include <cstdint>

#include "sh/sh4.h"

namespace apertura {

using Packed8 = std::array<int8_t, 4>;    // 4 bytes a point
using Packed16 = std::array<int16_t, 4>;  // 8 bytes a point

// Bounds on the errors of unpack(pack(v)), for any possible v. `area` is of A / 2 pi. `direction` is the
// length of the error of D / A: half a step a component from rounding, and a quarter of a step where the
// result is clamped to what is possible. The angle between the axes is at most asin(direction / |D / A|). `radius`,
// radians, is of the cap of the same area: 2 asin(sqrt(A / 4 pi)), whose slope by sqrt(A) is greatest at a hemisphere.
// A point that is open by no more than `closed` of the hemisphere comes back closed.
struct PackingError {
    double area, direction, closed, radius;
};
constexpr PackingError packingError(int bits) {
    const double step = 1.0 / ((1 << (bits - 1)) - 1);
    constexpr double halfDiagonal = 0.8660254037844386;  // sqrt(3) / 2
    return {step / 2 + step * step / 16, (halfDiagonal + 0.25) * step + 1e-6, step * step / 16, step / 2 + 1e-6};
}

// `v` is first clamped to what is possible (clampToPossible).
Packed8 pack8(const Visibility& v);
Packed16 pack16(const Visibility& v);

// Total over all bit patterns: the result is always possible, -128 reads as -127.
Visibility unpack(const Packed8& p);
Visibility unpack(const Packed16& p);

// The same from components as a vertex fetch or a glTF reader normalises them, -1..1.
Visibility unpack(const glm::vec4& normalised);

}  // namespace apertura
