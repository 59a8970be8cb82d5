// How parameters are packed: each field as numbers in -1..1, which the asset rounds to bytes or shorts.
#include <algorithm>
#include <cmath>

#include "apertura/sh/models.h"

namespace apertura {
namespace {

float finiteOrZero(float x) { return std::isfinite(x) ? x : 0; }

// Octahedral mapping: Meyer et al., "On Floating-Point Normal Vectors", 2010.
vec2 toOctahedral(const vec3& w) {
    const float sum = std::abs(w.x) + std::abs(w.y) + std::abs(w.z);
    if (!(sum > 0) || !std::isfinite(sum)) return {0, 0};
    const vec2 p = vec2(w) / sum;
    if (w.z >= 0) return p;
    return (1.0f - abs(vec2(p.y, p.x))) * vec2(p.x >= 0 ? 1 : -1, p.y >= 0 ? 1 : -1);
}
vec3 fromOctahedral(const vec2& p) {
    const float z = 1 - std::abs(p.x) - std::abs(p.y), fold = std::max(-z, 0.0f);
    return normalize(vec3(p.x + (p.x >= 0 ? -fold : fold), p.y + (p.y >= 0 ? -fold : fold), z));
}

// Maps a length of 0 or more to 0..1; its relative resolution is finest at `middle`.
float toShare(float length, float middle) { return length / (length + middle); }
float fromShare(float share, float middle) { return middle * share / std::max(1 - share, 0.004f); }
constexpr float kMiddleSlope = 4, kMiddleBend = 10;

// The edge of a lobe, -1..1: its offset, normalised by the length of (1, slope, offset).
float toEdge(float offset, float slope) { return offset / std::sqrt(1 + slope * slope + offset * offset); }
float fromEdge(float edge, float slope) {
    const float e = std::clamp(edge, -0.999f, 0.999f);
    return e * std::sqrt((1 + slope * slope) / (1 - e * e));
}

float* flat(vec4* slots) { return &slots->x; }
const float* flat(const vec4* slots) { return &slots->x; }

void packAxis(const vec3& axis, float* out) {
    const vec2 p = toOctahedral(axis);
    out[0] = p.x;
    out[1] = p.y;
}
vec3 unpackAxis(const float* in) { return fromOctahedral({in[0], in[1]}); }
void rotateAxis(vec4* slots, const mat3& rotation) { *slots = vec4(rotation * vec3(*slots), slots->w); }

void packCap(const vec4* slots, float* out) {
    packAxis(vec3(*slots), out);
    out[2] = aperturaCapRadius(finiteOrZero(slots->w)) / APERTURA_PI;
}
void unpackCap(const float* in, vec4* slots) { *slots = vec4(unpackAxis(in), 1 - std::cos(std::abs(in[2]) * APERTURA_PI)); }

void packLobe(const vec4* slots, float* out) {
    const float slope = finiteOrZero(length(vec3(*slots)));
    packAxis(vec3(*slots), out);
    out[2] = toShare(slope, kMiddleSlope);
    out[3] = toEdge(finiteOrZero(slots->w), slope);
}
void unpackLobe(const float* in, vec4* slots) {
    const float slope = fromShare(std::abs(in[2]), kMiddleSlope);
    *slots = vec4(slope * unpackAxis(in), fromEdge(in[3], slope));
}

// The rim of a hard lobe, -1..1: where its edge stands by the ratio x of its offset to its slope. Its angle from the plane of the axis,
// nearly: even steps of x, or of the edge above, would leave none for small openings, whose x is near 1. Beyond 1 the lobe has no edge.
// With bytes openings under 2.3 degrees in radius are none, and those up to 6 are 4.65.
constexpr float kRimShare = 0.9, kRimCurve = 1.37;
float toRim(float offset, float slope) {
    const float x = std::abs(offset) / slope;
    const float rim = x <= 1 ? kRimShare * std::asin(x * std::sin(kRimCurve)) / kRimCurve
                             : kRimShare + (1 - kRimShare) * std::min(std::cbrt(x - 1), 1.0f);
    return std::copysign(rim, offset);
}
float fromRim(float rim, float slope) {
    const float share = std::abs(rim) / kRimShare, beyond = (std::abs(rim) - kRimShare) / (1 - kRimShare);
    const float x = share <= 1 ? std::sin(share * kRimCurve) / std::sin(kRimCurve) : 1 + beyond * beyond * beyond;
    return std::copysign(x * slope, rim);
}

bool isSofter(const vec4& hardLobe) { return length(vec3(hardLobe)) < 0.5f * (kHardSharpness + kSofterSharpness); }
void packHardLobe(const vec4* slots, float* out) {
    packAxis(vec3(*slots), out);
    // 0..1, which leaves the sign for a flag
    out[2] = 0.5f + 0.5f * toRim(finiteOrZero(slots->w), isSofter(*slots) ? kSofterSharpness : kHardSharpness);
}
void unpackHardLobe(const float* in, vec4* slots) {
    *slots = vec4(kHardSharpness * unpackAxis(in), fromRim(2 * std::abs(in[2]) - 1, kHardSharpness));
}
// Its rim stays where it is.
void soften(vec4& hardLobe) { hardLobe *= kSofterSharpness / kHardSharpness; }

void packBend(const vec4* slots, float* out) {
    for (int i = 0; i < 5; ++i) {
        const float x = finiteOrZero(flat(slots)[i]);
        out[i] = std::copysign(std::sqrt(toShare(std::abs(x), kMiddleBend)), x);
    }
}
void unpackBend(const float* in, vec4* slots) {
    for (int i = 0; i < 5; ++i) flat(slots)[i] = std::copysign(fromShare(in[i] * in[i], kMiddleBend), in[i]);
}
void rotateBend(vec4* slots, const mat3& rotation) {
    const vec4 b = slots[0];
    const float yz = slots[1].x;
    const mat3 q(b.x, b.z, b.w, b.z, b.y, yz, b.w, yz, -b.x - b.y);
    const mat3 r = rotation * q * transpose(rotation);
    slots[0] = vec4(r[0][0], r[1][1], r[0][1], r[0][2]);
    slots[1].x = r[1][2];
}

template <int Count>
void packPlain(const vec4* slots, float* out) {
    std::copy_n(flat(slots), Count, out);
}
template <int Count>
void unpackPlain(const float* in, vec4* slots) {
    std::copy_n(in, Count, flat(slots));
}

// The coefficients of bands 2 to Top of the rotated function, by a product quadrature that is exact for them: five
// Gauss–Legendre nodes in z, ten azimuths.
template <int Top>
void rotateBands(vec4* slots, const mat3& rotation) {
    static const float nodes[5] = {-0.9061798459f, -0.5384693101f, 0, 0.5384693101f, 0.9061798459f};
    static const float weights[5] = {0.2369268851f, 0.4786286705f, 0.5688888889f, 0.4786286705f, 0.2369268851f};
    constexpr int count = Top == 2 ? 5 : 21;
    float out[24]{};
    for (int i = 0; i < 5; ++i)
        for (int k = 0; k < 10; ++k) {
            const float s = std::sqrt(1 - nodes[i] * nodes[i]), turn = 2 * APERTURA_PI * float(k) / 10;
            const vec3 w(s * std::cos(turn), s * std::sin(turn), nodes[i]);
            const AperturaHighBands here = aperturaHighBands(w), there = aperturaHighBands(transpose(rotation) * w);
            float value = 0;
            for (int c = 0; c < count; ++c) value += flat(slots)[c] * flat(there.c)[c];
            for (int c = 0; c < count; ++c) out[c] += weights[i] * 2 * APERTURA_PI / 10 * value * flat(here.c)[c];
        }
    std::copy_n(out, count, flat(slots));
}

// Heights about the normal are 0 or more, and stored as they are. Heights about the vertical are -1..1: their square roots, in which
// the low horizons of terrain are finest, become negative numbers, at least one step of a byte below 0.
constexpr float kLeastVertical = 1 / 127.0f;
template <int Count>
void packHeights(const vec4* slots, float* out) {
    const float* stored = flat(slots);
    const bool vertical = stored[0] < -0.5f;
    for (int i = 0; i < Count; ++i) {
        const float h = std::clamp(finiteOrZero(stored[i]) - (vertical ? APERTURA_ABOUT_VERTICAL : 0), -1.0f, 1.0f);
        const float root = std::copysign(std::sqrt(std::abs(h)), h);
        out[i] = vertical ? -(kLeastVertical + (1 - kLeastVertical) * (0.5f + 0.5f * root)) : std::max(h, 0.0f);
    }
}
template <int Count>
void unpackHeights(const float* in, vec4* slots) {
    const bool vertical = in[0] < 0;
    for (int i = 0; i < Count; ++i) {
        const float root = 2 * std::max((std::abs(in[i]) - kLeastVertical) / (1 - kLeastVertical), 0.0f) - 1;
        flat(slots)[i] = vertical ? std::copysign(root * root, root) + APERTURA_ABOUT_VERTICAL : std::max(in[i], 0.0f);
    }
}

template <int Count>
void packBits(const vec4* slots, float* out) {
    for (int i = 0; i < Count; ++i) out[i] = std::clamp(finiteOrZero(flat(slots)[i]), 0.0f, 127.0f) / 127;
}
template <int Count>
void unpackBits(const float* in, vec4* slots) {
    for (int i = 0; i < Count; ++i) flat(slots)[i] = std::round(std::max(in[i], 0.0f) * 127);
}

constexpr float kMostZonal = 0.8f;  // a bound of the integral of Y20 over any part of a hemisphere, which is 0.763 at most
void packZonal(const vec4* slots, float* out) { out[0] = slots->x / kMostZonal; }
void unpackZonal(const float* in, vec4* slots) { slots->x = in[0] * kMostZonal; }

// Heights, cubes and bits are made in the world, or about the normal there.
void rotateNothing(vec4*, const mat3&) {}

// How one field is packed, unpacked and rotated.
struct Packing {
    int numbers, slots;
    void (*pack)(const vec4* slots, float* numbers);  // defined for any values; the caller clamps the results
    void (*unpack)(const float* numbers, vec4* slots);
    void (*rotate)(vec4* slots, const mat3& rotation);
};

const Packing& packingOf(Field field) {
    static constexpr Packing cap{3, 1, packCap, unpackCap, rotateAxis};
    static constexpr Packing lobe{4, 1, packLobe, unpackLobe, rotateAxis};
    static constexpr Packing hardLobe{3, 1, packHardLobe, unpackHardLobe, rotateAxis};
    static constexpr Packing bend{5, 2, packBend, unpackBend, rotateBend};
    static constexpr Packing heights4{4, 1, packHeights<4>, unpackHeights<4>, rotateNothing};
    static constexpr Packing heights8{8, 2, packHeights<8>, unpackHeights<8>, rotateNothing};
    static constexpr Packing heights16{16, 4, packHeights<16>, unpackHeights<16>, rotateNothing};
    static constexpr Packing heights32{32, 8, packHeights<32>, unpackHeights<32>, rotateNothing};
    static constexpr Packing faces{6, 2, packPlain<6>, unpackPlain<6>, rotateNothing};
    static constexpr Packing zonal{1, 1, packZonal, unpackZonal, rotateNothing};
    static constexpr Packing bits32{5, 2, packBits<5>, unpackBits<5>, rotateNothing};
    static constexpr Packing bits128{19, 5, packBits<19>, unpackBits<19>, rotateNothing};
    static constexpr Packing bands2{5, 2, packPlain<5>, unpackPlain<5>, rotateBands<2>};
    static constexpr Packing bands4{21, 6, packPlain<21>, unpackPlain<21>, rotateBands<4>};
    switch (field) {
        case Field::Cap: return cap;
        case Field::Lobe: return lobe;
        case Field::HardLobe: return hardLobe;
        case Field::Bend: return bend;
        case Field::Heights4: return heights4;
        case Field::Heights8: return heights8;
        case Field::Heights16: return heights16;
        case Field::Heights32: return heights32;
        case Field::Faces: return faces;
        case Field::Zonal: return zonal;
        case Field::Bits32: return bits32;
        case Field::Bits128: return bits128;
        case Field::Bands2: return bands2;
        case Field::Bands4: return bands4;
        case Field::None: break;
    }
    static constexpr Packing none{};
    return none;
}

// Calls use(packing, first number, first slot) for each field that the model stores.
template <typename Use>
void forFields(const Model& model, Use&& use) {
    size_t number = 0, slot = 0;
    for (const Field field : model.stored) {
        if (field == Field::None) break;
        const Packing& packing = packingOf(field);
        use(packing, number, slot);
        number += size_t(packing.numbers);
        slot += size_t(packing.slots);
    }
}

// Flags a number by a negative sign. The third number of a cap, a lobe and a hard lobe is never negative by itself. A
// value that would round to zero is raised to the least one that keeps its sign in a byte.
void setFlag(float& number) { number = -std::max(number, 1 / 127.0f); }

bool hasHardLobes(const Model& model) { return model.stored[0] == Field::HardLobe; }

// The third number of the last lobe, whose sign says that all have the softer edge.
size_t softerFlag(const Model& model) { return size_t(3 * model.parts) - 1; }

// Models of three or more hard lobes flag their pairs by the signs of the third numbers of the second and the third lobe.
bool mayPair(const Model& model) { return model.parts >= 3 && hasHardLobes(model); }

}  // namespace

void fromPacking1(const Model& model, std::span<float> numbers) {
    if (!hasHardLobes(model)) return;
    const float slope = numbers[softerFlag(model)] < 0 ? kSofterSharpness : kHardSharpness;
    for (size_t k = 0; k < size_t(model.parts); ++k) {
        float& number = numbers[3 * k + 2];
        const float now = 0.5f + 0.5f * toRim(fromEdge(2 * std::abs(number) - 1, slope), slope);
        number = number < 0 ? -std::max(now, 1e-6f) : now;  // a flag is a sign, of more than 0
    }
}

int storedNumbers(const Model& model) {
    int sum = 0;
    forFields(model, [&](const Packing& packing, size_t, size_t) { sum += packing.numbers; });
    return sum;
}

void packParams(const Model& model, const ModelParams& params, std::span<float> numbers) {
    forFields(model, [&](const Packing& packing, size_t number, size_t slot) { packing.pack(&params[slot], &numbers[number]); });
    for (float& number : numbers) number = std::clamp(finiteOrZero(number), -1.0f, 1.0f);
    if (model.flagSlot() < 0 || !model.isStored()) return;
    const AperturaCombination combination = aperturaCombinationIn(params[size_t(model.flagSlot())]);
    if (combination.complement > 0.5f) setFlag(numbers[2]);
    if (mayPair(model) && combination.pairs > 0.5f) setFlag(numbers[5]);
    if (mayPair(model) && model.parts >= 4 && combination.pairs > 1.5f) setFlag(numbers[8]);
    if (hasHardLobes(model) && isSofter(params[size_t(model.parts) - 1])) setFlag(numbers[softerFlag(model)]);
}

ModelParams unpackParams(const Model& model, std::span<const float> numbers) {
    ModelParams params{};
    forFields(model, [&](const Packing& packing, size_t number, size_t slot) { packing.unpack(&numbers[number], &params[slot]); });
    if (model.flagSlot() < 0 || !model.isStored()) return params;
    if (hasHardLobes(model) && numbers[softerFlag(model)] < 0)
        for (size_t k = 0; k < size_t(model.parts); ++k) soften(params[k]);
    const float pairs = mayPair(model) ? float(numbers[5] < 0) + float(model.parts >= 4 && numbers[8] < 0) : 0;
    params[size_t(model.flagSlot())] = aperturaWithCombination(vec4(0), {numbers[2] < 0 ? 1.0f : 0.0f, pairs});
    return params;
}

ModelParams rotateParams(const Model& model, ModelParams params, const mat3& rotation) {
    forFields(model, [&](const Packing& packing, size_t, size_t slot) { packing.rotate(&params[slot], rotation); });
    return params;
}

ParamsError paramsError(const Model& model, int bits) {
    const double half = 0.5 / ((1 << (bits - 1)) - 1);  // of a step of a number
    ParamsError out;
    if (model.kind == ModelKind::Choice)
        for (const Model* chosen : autoModels()) {
            const ParamsError own = paramsError(*chosen, bits);
            out = {std::max(out.axis, own.axis), std::max(out.edge, own.edge)};
        }
    for (const Field field : model.stored) {
        // An edge e is o / sqrt(1 + s^2 + o^2), and stands at the angle asin(o / s) from the plane of the axis, as a rim does.
        const double edge = field == Field::Cap      ? APERTURA_PI * half
                          : field == Field::HardLobe ? 2 * half * kRimCurve / (kRimShare * std::sin(kRimCurve))
                          : field == Field::Lobe     ? half * std::sqrt(1 + 1 / double(kMiddleSlope * kMiddleSlope))
                                                     : 0;
        out.edge = std::max(out.edge, edge);
        if (edge > 0) out.axis = 3 * std::sqrt(2.0) * half;
    }
    return out;
}

}  // namespace apertura
