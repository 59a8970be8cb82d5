#pragma once
// The bytes of the asset's _VISIBILITY attribute: a VEC4 of normalised signed integers (glTF 2.0, 3.11),
// x, y, z = D / A, w = 2 sqrt(A / 2 pi) - 1. A closed point (A = 0) is 0, 0, 0, -1.
#include <array>
#include <cstdint>

#include "apertura/sh/sh4.h"
#include "apertura/sh/shading.h"

namespace apertura {

using Packed8 = std::array<int8_t, 4>;    // 4 bytes a point
using Packed16 = std::array<int16_t, 4>;  // 8 bytes a point

// Upper bounds on the errors of unpack(pack(v)), for any possible v, at 8 or 16 bits.
//   area       error of A / 2 pi
//   direction  length of the error of D / A: half a step in each component from rounding, and a quarter of a step where
//              the result is clamped to what is possible. The angle between the axes is at most asin(direction / |D / A|)
//   closed     a point that is open by no more than this fraction of the hemisphere comes back closed
//   radius     radians, error of the radius of the cap of the same area, 2 asin(sqrt(A / 4 pi)), whose slope by sqrt(A)
//              is greatest at a hemisphere
struct PackingError {
    double area, direction, closed, radius;
};
constexpr PackingError packingError(int bits) {
    const double step = 1.0 / ((1 << (bits - 1)) - 1);
    constexpr double halfDiagonal = 0.8660254037844386;  // sqrt(3) / 2
    return {step / 2 + step * step / 16, (halfDiagonal + 0.25) * step + 1e-6, step * step / 16, step / 2 + 1e-6};
}

// `v` is clamped to what is possible first (clampToPossible).
Packed8 pack8(const Visibility& v);
Packed16 pack16(const Visibility& v);

// Defined for all bit patterns: the result is always possible, and -128 reads as -127.
Visibility unpack(const Packed8& p);
Visibility unpack(const Packed16& p);

// The components in -1..1 that a vertex fetch or a glTF reader returns,
glm::vec4 normalised(const Packed8& p);
glm::vec4 normalised(const Packed16& p);

// and the visibility from these.
Visibility unpack(const glm::vec4& normalised);

// What surfaces reflect: the square roots of the shares, clamped to 0..1, over 255, and `towards` over 127. A share errs by at most 1/510
// of twice its root.
struct PackedBounce {
    std::array<uint8_t, 3> share;
    std::array<int8_t, 3> towards;
};
PackedBounce pack(const AperturaBounce& bounce);
// From the numbers that a reader returns, 0..1 and -1..1.
AperturaBounce unpackBounce(const glm::vec3& share, const glm::vec3& towards);

}  // namespace apertura
