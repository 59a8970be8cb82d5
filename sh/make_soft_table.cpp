// Writes the table that toSoft reads, one full solve per node. Runs at build time.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "apertura/sh/soft_solve.h"
#include "apertura/shaders/soft_grid.glsl"

using namespace apertura;

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    FILE* out = std::fopen(argv[1], "w");
    if (!out) return 1;
    constexpr double pi = std::numbers::pi;
    std::fprintf(out, "// Made by make_soft_table: the nodes of shaders/soft_grid.glsl.\n");
    for (int i = 0; i < APERTURA_SOFT_AREAS; ++i) {
        const double least = APERTURA_SOFT_LEAST_AREA;
        const double u = double(i) / (APERTURA_SOFT_AREAS - 1);
        const double x = std::clamp(u * u / (u * u + (1 - u) * (1 - u)), least, 1 - least);
        const double area = 2 * pi * x, haze = softStepInverse(x);
        const HardBoundary boundary(area);
        for (int j = 0; j < APERTURA_SOFT_PSIS; ++j) {
            const double p = 1 - 2.0 * j / (APERTURA_SOFT_PSIS - 1), psi = std::atan2(1 - std::abs(p), p);
            const double edge = boundary(psi);
            for (int k = 0; k < APERTURA_SOFT_REACHES; ++k) {
                const double reach = std::max(double(APERTURA_SOFT_REACH * float(k) / float(APERTURA_SOFT_REACHES - 1)), 1e-4);
                const double rho = 1 - (1 - reach) * (1 - reach);
                const double length = rho * edge * area / 2 * (1 - x);
                const SoftSolution s = solveSoft({area, area / 2 + length * std::cos(psi), length * std::sin(psi)});
                const double sharp = std::hypot(s.n, s.t);
                std::fprintf(out, "{%.8ef,%.8ef,%.8ef,%.8ef},", sharp * std::sqrt((1 - rho) * x * (1 - x)) / rho,
                             std::tan(std::remainder(std::atan2(s.t, s.n) - psi, 2 * pi) / 2),
                             s.offset / std::sqrt(1 + haze * haze + sharp * sharp), edge);
            }
            std::fprintf(out, "\n");
        }
    }
    return std::fclose(out) == 0 ? 0 : 1;
}
