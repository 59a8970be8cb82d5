#pragma once
// Values at samples that interpolate best what was seen between them.
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "apertura/sh/sh4.h"

namespace apertura {

// An unknown and its weight in a sum.
using Term = std::pair<uint32_t, float>;

// Visibility at unknown samples, from equations sum(weight * unknown) = value, each with a weight of its own: least squares, by conjugate
// gradients on the normal equations. (Kavan, Bargteil & Sloan, "Least Squares Vertex Baking", 2011.) The equations themselves are not
// kept: the memory grows with the pairs of unknowns that meet in one.
class LeastSquares {
public:
    explicit LeastSquares(size_t unknowns);

    // No unknown may be in `terms` twice.
    void add(std::span<const Term> terms, const Visibility& value, float weight = 1) {
        add(terms, {value.direction, value.area}, weight, false);
    }
    // The same for any four numbers.
    void add(std::span<const Term> terms, const glm::vec4& value, float weight = 1) { add(terms, value, weight, false); }
    // Draws two unknowns towards each other.
    void tie(uint32_t a, uint32_t b, float weight);

    // Draws a sum of unknowns towards nothing. No unknown may be in `terms` twice.
    void close(std::span<const Term> terms, float weight) { add(terms, glm::vec4(0), weight, true); }

    // The results are possible visibilities, and no nearer to a cap (capness) than the mean of what was seen about them. Unknowns without
    // an equation are closed.
    std::vector<Visibility> solve();

    // The same of any four numbers, as they come out. Unknowns without an equation are 0.
    std::vector<glm::vec4> solveFreely();

private:
    // Of the normal equations' matrix, above its diagonal.
    struct Entry {
        uint32_t row, column;
        float value;
    };

    void add(std::span<const Term> terms, const glm::vec4& value, float weight, bool isTie);
    void mergeEntries();
    std::vector<glm::vec4> means() const;

    std::vector<double> diagonal_, shares_;  // shares: of the values about each unknown, the sum of their weights
    std::vector<glm::dvec4> right_;          // the right-hand side
    std::vector<Entry> entries_;
    size_t mostEntries_;  // before they are merged
};

inline Visibility sumOf(std::span<const Term> terms, std::span<const Visibility> values) {
    Visibility out{glm::vec3(0), 0};
    for (const auto& [i, weight] : terms) out.direction += weight * values[i].direction, out.area += weight * values[i].area;
    return out;
}

}  // namespace apertura
