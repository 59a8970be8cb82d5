#pragma once
// Height fields of formulas.
#include <cmath>

#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/sampling/height_field.h"

namespace apertura::test {

template <typename F>
HeightField fieldOf(int width, int height, double spacingX, double spacingZ, const F& heightAt) {
    HeightField out{width, height, spacingX, spacingZ, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) out.heights.push_back(float(heightAt(x, y)));
    return out;
}

// Fractal mountains: six octaves of smooth noise over `cell` texels.
inline HeightField mountains(int width, int height, double spacingX, double spacingZ, double cell = 24, double amplitude = 300) {
    const auto noise = [](double x, double y, uint32_t seed) {
        const double fx = std::floor(x), fy = std::floor(y), u = x - fx, v = y - fy, su = u * u * (3 - 2 * u), sv = v * v * (3 - 2 * v);
        const auto at = [&](double dx, double dy) { return hashUnit(seed, uint64_t(fx + dx), uint64_t(fy + dy)); };
        return glm::mix(glm::mix(at(0, 0), at(1, 0), su), glm::mix(at(0, 1), at(1, 1), su), sv);
    };
    return fieldOf(width, height, spacingX, spacingZ, [&](int x, int y) {
        double sum = 0;
        for (uint32_t octave = 0; octave < 6; ++octave)
            sum += amplitude / (1 << octave) * noise(x * (1 << octave) / cell, y * (1 << octave) / cell, octave);
        return sum;
    });
}

}  // namespace apertura::test
