#include "apertura/bake/measure/storage_errors.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apertura/bake/sampling/directions.h"
#include "apertura/sh/packing.h"

namespace apertura {
namespace {

using glm::dvec3;
using std::numbers::pi;
constexpr double kDegree = pi / 180;

double radiusOf(double open) { return 2 * std::asin(std::sqrt(std::clamp(open, 0.0, 1.0) / 2)); }

DecodeError worstOf(int bits, double open, double capness) {
    const PackingError bound = packingError(bits);
    const double area = 2 * pi * open, offAxis = capness * (1 - area / (4 * pi));  // |D / A|
    DecodeError out{
        bits, open, capness, 0, std::asin(std::min(bound.direction / std::max(offAxis, 1e-9), 1.0)) / kDegree, 0, bound.radius / kDegree};
    for (int i = 0; i <= 400; ++i) {  // areas nearby: the rounding error of a single one is chance
        const double near = std::min(open * (0.9 + 0.2 * i / 400), 1.0);
        const Visibility v{{}, float(2 * pi * near)};
        const Visibility back = bits == 8 ? unpack(pack8(v)) : unpack(pack16(v));
        out.radius = std::max(out.radius, std::abs(radiusOf(back.area / (2 * pi)) - radiusOf(near)) / kDegree);
    }
    for (const glm::vec3& w : fibonacciCap(1500, 2)) {
        const Visibility v{float(area * offAxis) * w, float(area)};
        const Visibility back = bits == 8 ? unpack(pack8(v)) : unpack(pack16(v));
        const double length = glm::length(dvec3(back.direction));
        if (back.area <= 0) continue;  // closed: no axis
        const double cosine = length > 0 ? glm::dot(dvec3(back.direction), dvec3(w)) / length : 0;
        const double sine = length > 0 ? glm::length(glm::cross(dvec3(back.direction), dvec3(w))) / length : 1;
        out.axis = std::max(out.axis, std::atan2(sine, cosine) / kDegree);
    }
    return out;
}

// A point sees one cap. All in degrees: tilt from the normal, turn about it from +X, radius.
struct Seen {
    double tilt, turn, radius;
    Visibility visibility() const {
        const dvec3 axis(std::sin(tilt * kDegree) * std::cos(turn * kDegree), std::sin(tilt * kDegree) * std::sin(turn * kDegree),
                         std::cos(tilt * kDegree));
        const double half = std::sin(radius * kDegree / 2), area = 4 * pi * half * half;
        return {vec3(axis * area * (1 - area / (4 * pi))), float(area)};
    }
};
struct Pair {
    std::string_view name;
    Seen from, to;
};
constexpr Pair kPairs[] = {
    {"closed and open", {0, 0, 0}, {0, 0, 90}},
    {"closed and a window", {0, 0, 0}, {40, 0, 20}},
    {"open and a window", {0, 0, 90}, {40, 0, 20}},
    {"windows opposite each other", {60, 0, 25}, {60, 180, 25}},
    {"and low over the horizon", {85, 0, 20}, {85, 180, 20}},
    {"wide and narrow, one axis", {20, 0, 10}, {20, 0, 60}},
    {"axes 90 degrees apart", {45, 0, 40}, {45, 180, 40}},
    {"axes 20 degrees apart", {30, 0, 30}, {50, 0, 30}},
};

}  // namespace

std::vector<DecodeError> decodeErrors(int bits) {
    std::vector<DecodeError> out;
    for (const double open : {0.0003, 0.001, 0.003, 0.01, 0.03, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9, 1.0})
        for (const double capness : {0.02, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0}) out.push_back(worstOf(bits, open, capness));
    return out;
}

std::vector<MixingError> mixingErrors(const Model& model) {
    std::vector<MixingError> out;
    if (!model.mixes || !model.fromVisibility) return out;
    const vec3 normal(0, 0, 1);
    for (const Pair& pair : kPairs)
        for (const double radius : {0.27, 5.0, 15.0, 30.0}) {
            const Visibility a = pair.from.visibility(), b = pair.to.visibility();
            const ModelParams from = toParams(model, a, nullptr, normal), to = toParams(model, b, nullptr, normal);
            MixingError row{std::string(model.name), pair.name, radius, 0, 0, 0};
            for (const glm::vec3& w : fibonacciHemisphere(400)) {
                const AperturaCapLight light = aperturaCapLight(w, float(std::sin(radius * kDegree)));
                auto lit = [&](const Visibility& v, const ModelParams& params) {
                    return double(aperturaIrradianceThrough(model.id, aperturaRenormalised(model.id, toReceiver(v, params, normal)), light,
                                                            lightClassOf(light.sinRadius)))
                         / light.area;
                };
                const double first = lit(a, from), last = lit(b, to);
                for (int i = 1; i < 16; ++i) {
                    const float t = float(i) / 16;
                    ModelParams params{};
                    for (int k = 0; k < APERTURA_MAX_SLOTS; ++k) params[size_t(k)] = glm::mix(from[size_t(k)], to[size_t(k)], t);
                    const double e = lit({glm::mix(a.direction, b.direction, t), glm::mix(a.area, b.area, t)}, params);
                    row.below = std::max(row.below, std::min(first, last) - e);
                    row.above = std::max(row.above, e - std::max(first, last));
                    row.path = std::max(row.path, std::abs(e - glm::mix(first, last, double(t))));
                }
            }
            out.push_back(row);
        }
    return out;
}

}  // namespace apertura
