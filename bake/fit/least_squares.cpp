#include "bake/fit/least_squares.h"

#include <algorithm>
#include <array>
#include <numbers>

namespace apertura {
namespace {

constexpr float kOpen = 2 * std::numbers::pi_v<float>;
constexpr int kMostSteps = 100;
constexpr double kSmall = 1e-8;  // of the first residual, squared

// Four right-hand sides at once.
using Columns = std::vector<glm::dvec4>;

}  // namespace

void LeastSquares::add(std::span<const Term> terms, const glm::vec4& value, float weight, bool isTie) {
    terms_.insert(terms_.end(), terms.begin(), terms.end());
    starts_.push_back(terms_.size());
    equations_.push_back({value, weight, isTie});
    for (const auto& [i, w] : terms) diagonal_[i] += double(weight) * w * w;
}

void LeastSquares::tie(uint32_t a, uint32_t b, float weight) {
    const std::array<Term, 2> terms{{{a, 1.0f}, {b, -1.0f}}};
    add(terms, glm::vec4(0), weight, true);
}

std::vector<Visibility> LeastSquares::solve() const {
    const size_t n = diagonal_.size();
    const auto multiply = [&](const Columns& x, Columns& out) {  // by the matrix of the normal equations
        std::fill(out.begin(), out.end(), glm::dvec4(0));
        for (size_t e = 0; e < equations_.size(); ++e) {
            glm::dvec4 sum(0);
            for (size_t k = starts_[e]; k < starts_[e + 1]; ++k) sum += double(terms_[k].second) * x[terms_[k].first];
            sum *= double(equations_[e].weight);
            for (size_t k = starts_[e]; k < starts_[e + 1]; ++k) out[terms_[k].first] += double(terms_[k].second) * sum;
        }
    };
    // The start: means of the values about each unknown, by their weights.
    Columns x(n, glm::dvec4(0)), residual(n, glm::dvec4(0)), direction(n), image(n);
    std::vector<double> shares(n, 0);
    for (size_t e = 0; e < equations_.size(); ++e)
        for (size_t k = starts_[e]; k < starts_[e + 1]; ++k) {
            const double w = double(equations_[e].weight) * terms_[k].second;
            residual[terms_[k].first] += w * glm::dvec4(equations_[e].value);
            if (!equations_[e].isTie) shares[terms_[k].first] += w;
        }
    for (size_t i = 0; i < n; ++i)
        if (shares[i] > 0) x[i] = residual[i] / shares[i];
    const Columns means = x;
    multiply(x, image);
    const auto precondition = [&](size_t i) { return diagonal_[i] > 0 ? residual[i] / diagonal_[i] : glm::dvec4(0); };
    glm::dvec4 size(0);
    for (size_t i = 0; i < n; ++i) {
        residual[i] -= image[i];
        direction[i] = precondition(i);
        size += residual[i] * direction[i];
    }
    const auto ratio = [](const glm::dvec4& a, const glm::dvec4& b) {
        glm::dvec4 out;
        for (int c = 0; c < 4; ++c) out[c] = b[c] > 0 ? a[c] / b[c] : 0;
        return out;
    };
    const glm::dvec4 enough = kSmall * size;
    for (int step = 0; step < kMostSteps && glm::any(glm::greaterThan(size, enough)); ++step) {
        multiply(direction, image);
        glm::dvec4 along(0);
        for (size_t i = 0; i < n; ++i) along += direction[i] * image[i];
        const glm::dvec4 far = ratio(size, along);
        glm::dvec4 next(0);
        for (size_t i = 0; i < n; ++i) {
            x[i] += far * direction[i];
            residual[i] -= far * image[i];
            next += residual[i] * precondition(i);
        }
        const glm::dvec4 keep = ratio(next, size);
        for (size_t i = 0; i < n; ++i) direction[i] = precondition(i) + keep * direction[i];
        size = next;
    }
    std::vector<Visibility> out;
    out.reserve(n);
    for (size_t i = 0; i < n; ++i) {
        Visibility fitted = clampToPossible({glm::vec3(x[i]), std::clamp(float(x[i].w), 0.0f, kOpen)});
        // What overshoots would be an aperture with a sharper edge than anything that was seen.
        const float bound = fitted.area * (1 - fitted.area / (2 * kOpen)) * capness({glm::vec3(means[i]), float(means[i].w)});
        if (const float length = glm::length(fitted.direction); length > bound) fitted.direction *= bound / length;
        out.push_back(fitted);
    }
    return out;
}

}  // namespace apertura
