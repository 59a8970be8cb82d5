// How parameters travel: each field as numbers of -1..1, which the asset rounds to bytes or shorts.
#include <algorithm>
#include <cmath>

#include "sh/models.h"

namespace apertura {
namespace {

int numbersOf(Field field) {
    switch (field) {
        case Field::Cap:
        case Field::HardLobe: return 3;
        case Field::Lobe: return 4;
        case Field::Bend:
        case Field::Bands2: return 5;
        case Field::Heights: return HORIZON_AZIMUTHS;
        case Field::Bands4: return 21;
    }
    return 0;
}

// How many slots of the parameters the field takes.
int slotsOf(Field field) { return (std::max(numbersOf(field), 4) + 3) / 4; }

float finiteOrZero(float x) { return std::isfinite(x) ? x : 0; }
float toUnit(float x) { return std::clamp(finiteOrZero(x), -1.0f, 1.0f); }

// Octahedral: Meyer et al., "On Floating-Point Normal Vectors", 2010.
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

// A length of 0.. as 0..1, most finely about `middle`.
float toShare(float length, float middle) { return length / (length + middle); }
float fromShare(float share, float middle) { return middle * share / std::max(1 - share, 0.004f); }
constexpr float kMiddleSlope = 4, kMiddleBend = 10;

// The edge of a lobe: offset in units of 1 and the slope.
float toEdge(float offset, float slope) { return offset / std::sqrt(1 + slope * slope + offset * offset); }
float fromEdge(float edge, float slope) {
    const float e = std::clamp(edge, -0.999f, 0.999f);
    return e * std::sqrt((1 + slope * slope) / (1 - e * e));
}

void packLobe(const vec4& slot, float* out, bool firm) {
    const float slope = finiteOrZero(length(vec3(slot)));
    const vec2 axis = toOctahedral(vec3(slot));
    out[0] = axis.x;
    out[1] = axis.y;
    if (firm) {
        // Half way up: the sign is kept for the flag.
        out[2] = 0.5f + 0.5f * toEdge(finiteOrZero(slot.w), kHardSharpness);
    } else {
        out[2] = toShare(slope, kMiddleSlope);
        out[3] = toEdge(finiteOrZero(slot.w), slope);
    }
}

vec4 unpackLobe(const float* in, bool firm) {
    const vec3 axis = fromOctahedral({in[0], in[1]});
    if (firm) return vec4(kHardSharpness * axis, fromEdge(2 * std::abs(in[2]) - 1, kHardSharpness));
    const float slope = fromShare(std::abs(in[2]), kMiddleSlope);
    return vec4(slope * axis, fromEdge(in[3], slope));
}

float* flat(vec4* slots) { return &slots->x; }
const float* flat(const vec4* slots) { return &slots->x; }

void packField(Field field, const vec4* slots, float* out) {
    switch (field) {
        case Field::Cap: {
            const vec2 axis = toOctahedral(vec3(*slots));
            out[0] = axis.x;
            out[1] = axis.y;
            out[2] = capRadius(finiteOrZero(slots->w)) / PI;
            break;
        }
        case Field::Lobe: packLobe(*slots, out, false); break;
        case Field::HardLobe: packLobe(*slots, out, true); break;
        case Field::Bend:
            for (int i = 0; i < 5; ++i) {
                const float x = finiteOrZero(flat(slots)[i]);
                out[i] = std::copysign(std::sqrt(toShare(std::abs(x), kMiddleBend)), x);
            }
            break;
        case Field::Heights:
        case Field::Bands2:
        case Field::Bands4: std::copy_n(flat(slots), numbersOf(field), out); break;
    }
    for (int i = 0; i < numbersOf(field); ++i) out[i] = toUnit(out[i]);
}

void unpackField(Field field, const float* in, vec4* slots) {
    switch (field) {
        case Field::Cap: *slots = vec4(fromOctahedral({in[0], in[1]}), 1 - std::cos(std::abs(in[2]) * PI)); break;
        case Field::Lobe: *slots = unpackLobe(in, false); break;
        case Field::HardLobe: *slots = unpackLobe(in, true); break;
        case Field::Bend:
            for (int i = 0; i < 5; ++i) flat(slots)[i] = std::copysign(fromShare(in[i] * in[i], kMiddleBend), in[i]);
            break;
        case Field::Heights:
        case Field::Bands2:
        case Field::Bands4: std::copy_n(in, numbersOf(field), flat(slots)); break;
    }
}

// The coefficients of the bands 2 to `top` of the turned function, by a product quadrature that is exact for
// them: five nodes of Gauss and Legendre, ten azimuths.
void rotateBands(vec4* slots, int top, const mat3& rotation) {
    static const float nodes[5] = {-0.9061798459f, -0.5384693101f, 0, 0.5384693101f, 0.9061798459f};
    static const float weights[5] = {0.2369268851f, 0.4786286705f, 0.5688888889f, 0.4786286705f, 0.2369268851f};
    const int count = top == 2 ? 5 : 21;
    float out[24]{};
    for (int i = 0; i < 5; ++i)
        for (int k = 0; k < 10; ++k) {
            const float s = std::sqrt(1 - nodes[i] * nodes[i]), turn = 2 * PI * float(k) / 10;
            const vec3 w(s * std::cos(turn), s * std::sin(turn), nodes[i]);
            const HighBands here = highBands(w), there = highBands(transpose(rotation) * w);
            float value = 0;
            for (int c = 0; c < count; ++c) value += flat(slots)[c] * flat(there.c)[c];
            for (int c = 0; c < count; ++c) out[c] += weights[i] * 2 * PI / 10 * value * flat(here.c)[c];
        }
    std::copy_n(out, count, flat(slots));
}

// A cap's or a firm lobe's third number, and a lobe's, is never negative by itself: its sign is a flag. A
// value that would round to nothing moves up to the least that has a sign.
void setFlag(float& number) { number = -std::max(number, 1 / 127.0f); }

// Where the flags of pairs stand: the signs of the second and the third firm lobe, where there are three or more.
bool mayPair(const Model& model) { return model.storedFields >= 3 && model.stored[0] == Field::HardLobe; }

}  // namespace

int storedNumbers(const Model& model) {
    int sum = 0;
    for (int f = 0; f < model.storedFields; ++f) sum += numbersOf(model.stored[f]);
    return sum;
}

void packParams(const Model& model, const ModelParams& params, std::span<float> numbers) {
    size_t at = 0, slot = 0;
    for (int f = 0; f < model.storedFields; ++f) {
        packField(model.stored[f], &params[slot], &numbers[at]);
        at += size_t(numbersOf(model.stored[f]));
        slot += size_t(slotsOf(model.stored[f]));
    }
    if (model.combineSlot < 0) return;
    const vec4& how = params[size_t(model.combineSlot)];
    if (how.x > 0.5f) setFlag(numbers[2]);
    if (mayPair(model) && how.w > 0.5f) setFlag(numbers[5]);
    if (mayPair(model) && how.w > 1.5f) setFlag(numbers[8]);
}

ModelParams unpackParams(const Model& model, std::span<const float> numbers) {
    ModelParams params{};
    size_t at = 0, slot = 0;
    for (int f = 0; f < model.storedFields; ++f) {
        unpackField(model.stored[f], &numbers[at], &params[slot]);
        at += size_t(numbersOf(model.stored[f]));
        slot += size_t(slotsOf(model.stored[f]));
    }
    if (model.combineSlot >= 0) params[size_t(model.combineSlot)].x = numbers[2] < 0 ? 1 : 0;
    if (mayPair(model)) params[size_t(model.combineSlot)].w = (numbers[5] < 0 ? 1.0f : 0.0f) + (numbers[8] < 0 ? 1.0f : 0.0f);
    return params;
}

ModelParams rotateParams(const Model& model, ModelParams params, const mat3& rotation) {
    size_t slot = 0;
    for (int f = 0; f < model.storedFields; ++f) {
        vec4& first = params[slot];
        switch (model.stored[f]) {
            case Field::Cap:
            case Field::Lobe:
            case Field::HardLobe: first = vec4(rotation * vec3(first), first.w); break;
            case Field::Bend: {
                const vec4 b = first;
                const float yz = params[slot + 1].x;
                const mat3 q(b.x, b.z, b.w, b.z, b.y, yz, b.w, yz, -b.x - b.y);
                const mat3 r = rotation * q * transpose(rotation);
                first = vec4(r[0][0], r[1][1], r[0][1], r[0][2]);
                params[slot + 1].x = r[1][2];
                break;
            }
            case Field::Heights: break;  // about the normal in the world, whichever way the instance is turned
            case Field::Bands2: rotateBands(&first, 2, rotation); break;
            case Field::Bands4: rotateBands(&first, 4, rotation); break;
        }
        slot += size_t(slotsOf(model.stored[f]));
    }
    return params;
}

}  // namespace apertura
