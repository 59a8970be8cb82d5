#pragma once
// Means over a light by quadrature, weighted by the cosine to the normal, +Z.
#include <functional>

#include "apertura/sh/soft_solve.h"
#include "fitted.h"

namespace apertura::test {

struct Weighted {
    dvec3 direction;
    double weight;  // sum 1
};

inline std::vector<Weighted> lightDirections(const dvec3& axis, double radius, int rings = 16, int turns = 32) {
    const dvec3 u = normalize(cross(axis, dvec3(0.3, 0.5, 0.81))), v = cross(axis, u);
    std::vector<Weighted> out;
    double sum = 0;
    for (int a = 0; a < rings; ++a)
        for (int b = 0; b < turns; ++b) {
            const double h = (1 - std::cos(radius)) * (a + 0.5) / rings, s = std::sqrt(h * (2 - h)),
                         turn = 2 * pi * (b + 0.5 * (a % 2)) / turns;
            const dvec3 w = (1 - h) * axis + s * (std::cos(turn) * u + std::sin(turn) * v);
            if (w.z <= 0) continue;
            out.push_back({w, w.z});
            sum += w.z;
        }
    for (Weighted& w : out) w.weight /= sum;
    return out;
}

// A plane through the directions, whose edge lies within the light or near it.
//   sharpness  the slope's length
inline vec4 lobeAcross(Random& random, const dvec3& axis, double radius, double sharpness) {
    const dvec3 slope = sharpness * random.direction();
    const double along = dot(slope, axis), across = std::sqrt(std::max(dot(slope, slope) - along * along, 0.0));
    return vec4(vec3(slope), float(-along + random(-1, 1) * (1.5 + 1.2 * across * std::sin(radius))));
}

// The largest step of the light on a surface, whose normal is +Z, from a light that moves along a great circle over one of some receivers,
// as a share of what a moving light can at most change: 2 / (pi sin r) a radian.
//   radii   of the lights, radians
//   light   E of a light on receiver i of `count`; it depends on i and the light alone
template <typename AperturaLight>
double steepest(int count, const std::vector<double>& radii, AperturaLight&& light) {
    Random random(106);
    double out = 0;
    for (int i = 0; i < count; ++i) {
        const dvec3 first = random.direction(), second = normalize(cross(first, random.direction()));
        for (const double radius : radii) {
            const double step = 0.1 * radius;
            double before = -1;
            for (double at = 0; at < 2 * pi; at += step) {
                const AperturaCapLight moved = test::aperturaCapLight(std::cos(at) * first + std::sin(at) * second, radius);
                const double now = moved.axis.z < -moved.sinRadius ? 0 : normalised(light(i, moved), radius);
                if (before >= 0) out = std::max(out, std::abs(now - before) / step * pi * std::sin(radius) / 2);
                before = now;
            }
        }
    }
    return out;
}

inline double stepAt(const vec4& lobe, const dvec3& w) { return softStepExact(lobe.w + dot(dvec3(vec3(lobe)), w)); }

}  // namespace apertura::test
