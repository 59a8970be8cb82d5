#include "apertura/sh/packing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace apertura {
namespace {

constexpr float kTwoPi = float(2 * std::numbers::pi);

template <typename Int>
std::array<Int, 4> pack(const Visibility& any) {
    constexpr float top = std::numeric_limits<Int>::max();
    const Visibility v = clampToPossible(any);
    const Int w = Int(std::lround((2 * std::sqrt(v.area / kTwoPi) - 1) * top));
    if (w == -Int(top)) return {0, 0, 0, w};
    std::array<Int, 4> out{0, 0, 0, w};
    for (int i = 0; i < 3; ++i) out[i] = Int(std::lround(std::clamp(v.direction[i] / v.area, -1.0f, 1.0f) * top));
    return out;
}

template <typename Int>
glm::vec4 normalisedInts(const std::array<Int, 4>& p) {
    constexpr float top = std::numeric_limits<Int>::max();
    glm::vec4 out;
    for (int i = 0; i < 4; ++i) out[i] = std::max(p[i] / top, -1.0f);
    return out;
}

}  // namespace

Packed8 pack8(const Visibility& v) { return pack<int8_t>(v); }
Packed16 pack16(const Visibility& v) { return pack<int16_t>(v); }
glm::vec4 normalised(const Packed8& p) { return normalisedInts(p); }
glm::vec4 normalised(const Packed16& p) { return normalisedInts(p); }
Visibility unpack(const Packed8& p) { return unpack(normalised(p)); }
Visibility unpack(const Packed16& p) { return unpack(normalised(p)); }

Visibility unpack(const glm::vec4& normalised) {
    const float root = (normalised.w + 1) / 2;
    const float area = kTwoPi * root * root;
    return clampToPossible({glm::vec3(normalised) * area, area});
}

PackedBounce pack(const AperturaBounce& bounce) {
    PackedBounce out{};
    const float length = glm::length(bounce.towards);
    for (int c = 0; c < 3; ++c) {
        out.share[size_t(c)] = uint8_t(std::lround(255 * std::sqrt(std::clamp(bounce.share[c], 0.0f, 1.0f))));
        out.towards[size_t(c)] = int8_t(std::lround(127 * bounce.towards[c] / std::max(length, 1.0f)));
    }
    return out;
}

AperturaBounce unpackBounce(const glm::vec3& share, const glm::vec3& towards) {
    return {share * share, towards / std::max(glm::length(towards), 1.0f)};
}

}  // namespace apertura
