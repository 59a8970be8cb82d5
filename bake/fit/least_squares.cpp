#include "apertura/bake/fit/least_squares.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <numbers>

namespace apertura {
namespace {

constexpr float kOpen = 2 * std::numbers::pi_v<float>;
constexpr int kMostSteps = 100;
constexpr double kSmall = 1e-8;      // of the first residual, squared
constexpr size_t kBlock = 8192;      // unknowns that one thread works on at a time
constexpr size_t kFewEntries = 256;  // are not worth merging

// Four right-hand sides at once.
using Columns = std::vector<glm::dvec4>;

// Calls use(i) for 0 .. n - 1, in parallel if they are many, and returns the sum of its results: the same for any number of threads.
glm::dvec4 sumOver(size_t n, const auto& use) {
    const auto sumBlock = [&](size_t block) {
        glm::dvec4 sum(0);
        for (size_t i = block * kBlock; i < std::min(n, (block + 1) * kBlock); ++i) sum += use(i);
        return sum;
    };
    if (n <= kBlock) return sumBlock(0);
    std::vector<glm::dvec4> sums((n + kBlock - 1) / kBlock);
    tbb::parallel_for(size_t(0), sums.size(), [&](size_t block) { sums[block] = sumBlock(block); });
    glm::dvec4 all(0);
    for (const glm::dvec4& sum : sums) all += sum;
    return all;
}

glm::dvec4 ratio(const glm::dvec4& a, const glm::dvec4& b) {
    glm::dvec4 out;
    for (int c = 0; c < 4; ++c) out[c] = b[c] > 0 ? a[c] / b[c] : 0;
    return out;
}

}  // namespace

LeastSquares::LeastSquares(size_t unknowns)
    : diagonal_(unknowns, 0), shares_(unknowns, 0), right_(unknowns, glm::dvec4(0)), mostEntries_(kFewEntries + 4 * unknowns) {}

void LeastSquares::add(std::span<const Term> terms, const glm::vec4& value, float weight, bool isTie) {
    for (size_t k = 0; k < terms.size(); ++k) {
        const auto& [i, w] = terms[k];
        diagonal_[i] += double(weight) * w * w;
        right_[i] += double(weight) * w * glm::dvec4(value);
        if (!isTie) shares_[i] += double(weight) * w;
        for (size_t other = 0; other < k; ++other) {
            const auto& [j, v] = terms[other];
            entries_.push_back({std::min(i, j), std::max(i, j), weight * w * v});
        }
    }
    if (entries_.size() <= mostEntries_) return;
    mergeEntries();
    mostEntries_ = std::max(mostEntries_, 2 * entries_.size());
}

void LeastSquares::tie(uint32_t a, uint32_t b, float weight) {
    const std::array<Term, 2> terms{{{a, 1.0f}, {b, -1.0f}}};
    add(terms, glm::vec4(0), weight, true);
}

// Sorts the entries by row and column and makes one of those that have both alike.
void LeastSquares::mergeEntries() {
    std::vector<size_t> ends(diagonal_.size(), 0);  // of the rows
    for (const Entry& e : entries_) ++ends[e.row];
    size_t before = 0;
    for (size_t& end : ends) before = end += before;
    std::vector<Entry> sorted(entries_.size());
    for (size_t e = entries_.size(); e-- > 0;) sorted[--ends[entries_[e].row]] = entries_[e];
    size_t kept = 0;
    for (size_t from = 0, to = 0; from < sorted.size(); from = to) {
        while (to < sorted.size() && sorted[to].row == sorted[from].row) ++to;
        std::stable_sort(sorted.begin() + long(from), sorted.begin() + long(to),
                         [](const Entry& a, const Entry& b) { return a.column < b.column; });
        const size_t first = kept;
        for (size_t e = from; e < to; ++e)
            if (kept > first && sorted[kept - 1].column == sorted[e].column)
                sorted[kept - 1].value += sorted[e].value;
            else
                sorted[kept++] = sorted[e];
    }
    sorted.resize(kept);
    entries_ = std::move(sorted);
}

// Of the values about each unknown, by their weights.
std::vector<glm::vec4> LeastSquares::means() const {
    std::vector<glm::vec4> out(right_.size(), glm::vec4(0));
    for (size_t i = 0; i < out.size(); ++i)
        if (shares_[i] > 0) out[i] = right_[i] / shares_[i];
    return out;
}

std::vector<glm::vec4> LeastSquares::solveFreely() {
    const size_t n = diagonal_.size();
    mergeEntries();
    // The whole matrix but its diagonal, row after row.
    std::vector<size_t> starts(n + 1, 0);
    for (const Entry& e : entries_) ++starts[e.row + 1], ++starts[e.column + 1];
    for (size_t i = 0; i < n; ++i) starts[i + 1] += starts[i];
    std::vector<std::pair<uint32_t, float>> elements(2 * entries_.size());
    {
        std::vector<size_t> next(starts.begin(), starts.end() - 1);
        for (const Entry& e : entries_) {
            elements[next[e.row]++] = {e.column, e.value};
            elements[next[e.column]++] = {e.row, e.value};
        }
    }
    const auto product = [&](const Columns& x, size_t i) {
        glm::dvec4 sum = diagonal_[i] * x[i];
        for (size_t k = starts[i]; k < starts[i + 1]; ++k) sum += double(elements[k].second) * x[elements[k].first];
        return sum;
    };
    const std::vector<glm::vec4> start = means();
    Columns x(start.begin(), start.end()), residual(n), direction(n), image(n);
    const auto precondition = [&](size_t i) { return diagonal_[i] > 0 ? residual[i] / diagonal_[i] : glm::dvec4(0); };
    glm::dvec4 size = sumOver(n, [&](size_t i) {
        residual[i] = right_[i] - product(x, i);
        direction[i] = precondition(i);
        return residual[i] * direction[i];
    });
    const glm::dvec4 enough = kSmall * size;
    for (int step = 0; step < kMostSteps && glm::any(glm::greaterThan(size, enough)); ++step) {
        const glm::dvec4 along = sumOver(n, [&](size_t i) { return direction[i] * (image[i] = product(direction, i)); });
        const glm::dvec4 far = ratio(size, along);
        const glm::dvec4 next = sumOver(n, [&](size_t i) {
            x[i] += far * direction[i];
            residual[i] -= far * image[i];
            return residual[i] * precondition(i);
        });
        const glm::dvec4 keep = ratio(next, size);
        for (size_t i = 0; i < n; ++i) direction[i] = precondition(i) + keep * direction[i];
        size = next;
    }
    return {x.begin(), x.end()};
}

std::vector<Visibility> LeastSquares::solve() {
    const std::vector<glm::vec4> x = solveFreely(), seen = means();
    std::vector<Visibility> out;
    out.reserve(x.size());
    for (size_t i = 0; i < x.size(); ++i) {
        Visibility fitted = clampToPossible({glm::vec3(x[i]), std::clamp(x[i].w, 0.0f, kOpen)});
        // What overshoots would be an aperture with a sharper edge than anything that was seen.
        const float bound = fitted.area * (1 - fitted.area / (2 * kOpen)) * capness({glm::vec3(seen[i]), seen[i].w});
        if (const float length = glm::length(fitted.direction); length > bound) fitted.direction *= bound / length;
        out.push_back(fitted);
    }
    return out;
}

}  // namespace apertura
