#include "apertura/bake/fit/face_unknowns.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "apertura/bake/sampling/classes.h"
#include "apertura/sh/shading.h"

namespace apertura {
namespace {

constexpr float kSmooth = 0.7f;  // the least cosine between faces that meet smoothly,
constexpr float kFlat = 0.98f;   // and where each looks about its own normal

}  // namespace

Unknowns::Unknowns(const Scene& scene, size_t instance, std::vector<uint8_t> levels, std::vector<bool> leans)
    : surface_(scene.surfaces[size_t(scene.instances[instance].surface)]), levels_(std::move(levels)), leans_(std::move(leans)) {
    for (size_t t = 0; t < levels_.size(); ++t) normals_.push_back(surfaceAt(scene, int(instance), int(t), glm::vec3(1 / 3.0f)).face);
    weldVertices();
    pairEdges();
    joinCorners();
    numberSamples();
}

int64_t Unknowns::across(size_t t, int e) const {
    const uint32_t other = across_[3 * t + size_t(e)];
    return other == kNone ? -1 : int64_t(other / 3);
}

std::vector<Term> Unknowns::sample(size_t t, int at) const {
    const int level = levels_[t], steps = aperturaLatticeSteps(std::max(level, 1));
    if (level == 0) return {{vertexUnknowns_[surface_.triangles[t][size_t(at)]], 1.0f}};
    int j = 0;
    while (aperturaLatticeRow(j + 1, steps) <= at) ++j;
    const int i = at - aperturaLatticeRow(j, steps), k = steps - i - j;
    if (k == steps) return {{cornerUnknowns_[3 * t], 1.0f}};
    if (i == steps) return {{cornerUnknowns_[3 * t + 1], 1.0f}};
    if (j == steps) return {{cornerUnknowns_[3 * t + 2], 1.0f}};
    if (j == 0) return alongEdge(t, 0, i);
    if (k == 0) return alongEdge(t, 1, j);
    if (i == 0) return alongEdge(t, 2, k);
    // The inner samples of rows 1 .. steps - 2, of which row r has steps - 1 - r.
    const int before = (j - 1) * (steps - 1) - j * (j - 1) / 2;
    return {{firstInside_[t] + uint32_t(before + i - 1), 1.0f}};
}

std::vector<Term> Unknowns::point(size_t t, const glm::vec3& weights) const {
    std::vector<Term> out;
    const auto add = [&](int at, float weight) {
        for (const auto& [unknown, share] : sample(t, at)) {
            const auto found = std::find_if(out.begin(), out.end(), [&, u = unknown](const Term& term) { return term.first == u; });
            if (found == out.end())
                out.emplace_back(unknown, weight * share);
            else
                found->second += weight * share;
        }
    };
    if (levels_[t] == 0) {
        for (int c = 0; c < 3; ++c) add(c, weights[c]);
    } else {
        const AperturaLatticeCell cell = aperturaLatticeCell(weights, aperturaLatticeSteps(levels_[t]));
        for (int c = 0; c < 3; ++c) add(cell.samples[c], cell.weights[c]);
    }
    return out;
}

void Unknowns::weldVertices() {
    const auto place = [&](uint32_t v) {
        const glm::vec3 p = surface_.positions[v], n = surface_.normals[v];
        return std::array{p.x, p.y, p.z, n.x, n.y, n.z};
    };
    std::vector<uint32_t> order(surface_.positions.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return std::pair(place(a), a) < std::pair(place(b), b); });
    // Numbered by the first vertex of each place, so that neighbours in the mesh are neighbours in memory.
    std::vector<uint32_t> first(order.size());
    for (size_t i = 0; i < order.size(); ++i)
        first[order[i]] = i > 0 && place(order[i]) == place(order[i - 1]) ? first[order[i - 1]] : order[i];
    welded_.resize(order.size());
    for (size_t v = 0; v < first.size(); ++v) welded_[v] = first[v] == v ? groups_++ : welded_[first[v]];
}

void Unknowns::pairEdges() {
    const size_t triangles = surface_.triangles.size();
    std::vector<std::pair<uint64_t, uint32_t>> edges;  // its groups, and 3 t + e: the edge from corner e to e + 1
    for (size_t t = 0; t < triangles; ++t)
        for (int e = 0; e < 3; ++e) {
            const uint64_t a = group(t, e), b = group(t, e + 1);
            if (a != b && normals_[t] != glm::vec3(0))
                edges.emplace_back(std::min(a, b) << 32 | std::max(a, b), uint32_t(3 * t + size_t(e)));
        }
    std::sort(edges.begin(), edges.end());
    across_.assign(3 * triangles, kNone);
    for (size_t i = 0; i + 1 < edges.size(); ++i) {
        const bool two = edges[i].first == edges[i + 1].first && (i == 0 || edges[i - 1].first != edges[i].first)
                      && (i + 2 == edges.size() || edges[i + 2].first != edges[i].first);
        const uint32_t a = edges[i].second, b = edges[i + 1].second;
        const bool leans = leans_[a / 3];
        if (!two || leans != leans_[b / 3] || glm::dot(normals_[a / 3], normals_[b / 3]) < (leans ? kFlat : kSmooth)) continue;
        across_[a] = b, across_[b] = a;
    }
}

void Unknowns::joinCorners() {
    const size_t triangles = surface_.triangles.size();
    Classes classes(3 * triangles + groups_);
    const auto vertexClass = [&](uint32_t g) { return uint32_t(3 * triangles) + g; };
    for (size_t t = 0; t < triangles; ++t)
        for (int c = 0; c < 3; ++c)
            if (levels_[t] == 0) classes.join(uint32_t(3 * t + size_t(c)), vertexClass(group(t, c)));
    for (size_t t = 0; t < triangles; ++t)
        for (int e = 0; e < 3; ++e) {
            const uint32_t other = across_[3 * t + size_t(e)];
            if (other == kNone) continue;
            for (const int c : {e, (e + 1) % 3})
                for (int d = 0; d < 3; ++d)
                    if (group(other / 3, d) == group(t, c)) classes.join(uint32_t(3 * t + size_t(c)), other / 3 * 3 + uint32_t(d));
        }
    std::vector<uint32_t> number(3 * triangles + groups_, kNone);
    const auto numbered = [&](uint32_t element) {
        uint32_t& n = number[classes.find(element)];
        if (n == kNone) n = uint32_t(count_++);
        return n;
    };
    for (size_t v = 0; v < welded_.size(); ++v) vertexUnknowns_.push_back(numbered(vertexClass(welded_[v])));
    for (size_t t = 0; t < triangles; ++t)
        for (uint32_t c = 0; c < 3; ++c) cornerUnknowns_.push_back(levels_[t] ? numbered(uint32_t(3 * t) + c) : 0);
}

void Unknowns::numberSamples() {
    const size_t triangles = surface_.triangles.size();
    edges_.assign(3 * triangles, {});
    firstInside_.assign(triangles, 0);
    for (size_t t = 0; t < triangles; ++t) {
        if (levels_[t] == 0) continue;
        for (uint32_t e = 0; e < 3; ++e) {
            const uint32_t own = uint32_t(3 * t) + e, other = across_[own];
            if (other != kNone && other < own && levels_[other / 3] > 0) {
                const Edge& shared = edges_[other];
                edges_[own] = {shared.first, shared.steps, group(t, int(e)) == group(other / 3, int(other % 3))};
                continue;
            }
            const int level = other == kNone ? levels_[t] : std::min(levels_[t], levels_[other / 3]);
            const int steps = aperturaLatticeSteps(std::max(level, 1));  // beside a face of vertices alone, the line between its ends
            edges_[own] = {uint32_t(count_), steps, true};
            count_ += size_t(steps - 1);
        }
        const int steps = aperturaLatticeSteps(levels_[t]);
        firstInside_[t] = uint32_t(count_);
        count_ += size_t((steps - 1) * (steps - 2) / 2);
    }
}

// Step `s` of the steps along a triangle's edge.
std::vector<Term> Unknowns::alongEdge(size_t t, int e, int s) const {
    const Edge& edge = edges_[3 * t + size_t(e)];
    const int steps = aperturaLatticeSteps(levels_[t]), own = edge.steps;
    if (!edge.forwards) s = steps - s;
    const uint32_t from = cornerUnknowns_[3 * t + size_t(edge.forwards ? e : (e + 1) % 3)],
                   to = cornerUnknowns_[3 * t + size_t(edge.forwards ? (e + 1) % 3 : e)];
    const int scaled = s * own, low = scaled / steps;
    const float share = float(scaled % steps) / float(steps);
    const auto at = [&](int i) { return i == 0 ? from : i == own ? to : edge.first + uint32_t(i - 1); };
    if (share == 0) return {{at(low), 1.0f}};
    return {{at(low), 1 - share}, {at(low + 1), share}};
}

}  // namespace apertura
