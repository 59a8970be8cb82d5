#pragma once
// Several lobes over a light: cases with their integrals, and the largest step.
#include "light_integral.h"

namespace apertura::test {

struct LobeCase {
    dvec3 axis;
    double radius, open, product;  // open: E / (pi sin^2 r) without lobes; product: the mean of the lobes' product
    AperturaReceiver receiver;
};

inline AperturaReceiver receiverOfLobes(const std::vector<vec4>& lobes) {
    AperturaReceiver receiver{vec3(0, 0, 1), vec4(0, 0, float(pi), float(2 * pi)), {}};
    for (size_t k = 0; k < lobes.size(); ++k) receiver.params[k] = lobes[k];
    return receiver;
}

// Hard lobes, as firm-N has them, across lights or near; in half of the cases the edges of the first two nearly coincide.
inline std::vector<LobeCase> lobeCases(int count, int cases, double leastDegrees, double largestDegrees) {
    Random random(110);
    std::vector<LobeCase> out;
    for (int i = 0; i < cases; ++i) {
        LobeCase c{{}, leastDegrees * std::pow(largestDegrees / leastDegrees, random()) * pi / 180, 0, 0, {}};
        const double z = random(-0.5 * std::sin(c.radius), 1);
        c.axis = dvec3(std::sqrt(1 - z * z), 0, z);
        std::vector<vec4> lobes;
        for (int k = 0; k < count; ++k) lobes.push_back(lobeAcross(random, c.axis, c.radius, random() < 0.5 ? 60 : 15));
        if (i % 2) {
            const float side = random() < 0.5 ? 1.0f : -1.0f, size = length(vec3(lobes[1]));
            const vec3 near = normalize(side * normalize(vec3(lobes[0])) + 0.3f * vec3(random.direction()));
            const float was = lobes[1].w + dot(vec3(lobes[1]), vec3(c.axis));
            lobes[1] = vec4(size * near, was - size * dot(near, vec3(c.axis)));
        }
        c.open = exactFraction({0, 0, 1}, {{c.axis, c.radius}}, c.radius);
        for (const Weighted& w : lightDirections(c.axis, c.radius)) {
            double product = w.weight;
            for (const vec4& lobe : lobes) product *= stepAt(lobe, w.direction);
            c.product += product;
        }
        c.receiver = receiverOfLobes(lobes);
        out.push_back(c);
    }
    return out;
}

inline double rmsOf(const std::vector<LobeCase>& cases, int model, int lightClass) {
    double sum = 0;
    for (const LobeCase& c : cases) {
        const float e = aperturaIrradianceThrough(model, c.receiver, test::aperturaCapLight(c.axis, c.radius), lightClass);
        sum += std::pow(normalised(e, c.radius) - c.open * c.product, 2);
    }
    return std::sqrt(sum / double(cases.size()));
}

// Over lobes of slope 60 anywhere, every third pair of them with one edge.
inline double steepestOfLobes(int count, int model, int lightClass, const std::vector<double>& radii, int receivers = 60) {
    static std::vector<AperturaReceiver> made;
    if (made.empty()) {
        Random random(111);
        for (int i = 0; i < receivers; ++i) {
            std::vector<vec4> lobes;
            for (int k = 0; k < count; ++k) {
                const vec3 slope = k > 0 && i % 3 == 0 ? vec3(lobes[0]) : 60.0f * vec3(random.direction());
                lobes.push_back(k > 0 && i % 3 == 0 ? lobes[0] : vec4(slope, 60 * float(random(-0.5, 0.5))));
            }
            made.push_back(receiverOfLobes(lobes));
        }
    }
    return steepest(receivers, radii, [&](int i, const AperturaCapLight& light) {
        return aperturaIrradianceThrough(model, made[size_t(i)], light, lightClass);
    });
}

}  // namespace apertura::test
