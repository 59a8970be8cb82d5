#pragma once
// Values at samples that interpolate best what was seen between them.
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sh/sh4.h"

namespace apertura {

// An unknown and its weight in a sum.
using Term = std::pair<uint32_t, float>;

// Visibility at unknown samples, from equations sum(weight * unknown) = value, each with a weight of its own: least squares, by conjugate
// gradients on the normal equations. (Kavan, Bargteil & Sloan, "Least Squares Vertex Baking", 2011.)
class LeastSquares {
public:
    explicit LeastSquares(size_t unknowns) : diagonal_(unknowns, 0), starts_{0} {}

    void add(std::span<const Term> terms, const Visibility& value, float weight = 1) {
        add(terms, {value.direction, value.area}, weight, false);
    }
    // Draws two unknowns towards each other.
    void tie(uint32_t a, uint32_t b, float weight);

    // The results are possible visibilities, and no nearer to a cap
    // (capness) than the mean of what was seen about them. Unknowns without an equation are closed.
    std::vector<Visibility> solve() const;

private:
    void add(std::span<const Term> terms, const glm::vec4& value, float weight, bool isTie);

    struct Equation {
        glm::vec4 value;
        float weight;
        bool isTie;
    };
    std::vector<double> diagonal_;  // of the normal equations
    std::vector<Equation> equations_;
    std::vector<size_t> starts_;  // of each equation's terms, and the end
    std::vector<Term> terms_;
};

inline Visibility sumOf(std::span<const Term> terms, std::span<const Visibility> values) {
    Visibility out{glm::vec3(0), 0};
    for (const auto& [i, weight] : terms) out.direction += weight * values[i].direction, out.area += weight * values[i].area;
    return out;
}

}  // namespace apertura
