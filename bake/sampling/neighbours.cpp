#include "apertura/bake/sampling/neighbours.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "apertura/runtime/asset/faces.h"
#include "apertura/sh/shading.h"

namespace apertura {
namespace {

constexpr float kTwinCosine = 0.866f;

}  // namespace

Neighbours::Neighbours(size_t points, std::vector<std::pair<uint32_t, uint32_t>> edges, Edges kind) : first_(points + 1, 0) {
    if (kind == Edges::BothWays)
        for (size_t i = 0, n = edges.size(); i < n; ++i) edges.emplace_back(edges[i].second, edges[i].first);
    std::erase_if(edges, [](const auto& edge) { return edge.first == edge.second; });
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    all_.reserve(edges.size());
    for (const auto& [from, to] : edges) {
        ++first_[from + 1];
        all_.push_back(to);
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
}

std::vector<uint32_t> Neighbours::withinTwo(size_t point) const {
    std::vector<uint32_t> out(of(point).begin(), of(point).end());
    for (const uint32_t near : of(point)) out.insert(out.end(), of(near).begin(), of(near).end());
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    std::erase(out, uint32_t(point));
    return out;
}

StoredPoints::StoredPoints(const Scene& scene, size_t instance, const SeenOnFaces* faces) {
    const Surface& surface = scene.surfaces[scene.instances[instance].surface];
    const size_t vertices = surface.positions.size(), samples = faces ? faces->visibility.size() : 0;
    places_.resize(vertices + samples);
    // In the surface's own frame. Steps are powers of two, so that the two triangles of an edge place its samples alike to the last bit.
    std::vector<glm::dvec3> at(vertices + samples);
    std::vector<glm::vec3> normal(vertices + samples);
    for (size_t v = 0; v < vertices; ++v) at[v] = surface.positions[v], normal[v] = surface.normals[v];
    std::vector<std::pair<uint32_t, uint32_t>> edges;
    for (size_t t = 0; t < surface.triangles.size(); ++t) {
        const auto& corners = surface.triangles[t];
        const int level = faces ? faces->level(t) : 0;
        for (int c = 0; c < 3 && level == 0; ++c) {
            Place& place = places_[corners[size_t(c)]];
            if (place.triangle < 0) {
                place = {int(t), glm::vec3(0)};
                place.barycentrics[c] = 1;
            }
            edges.emplace_back(corners[size_t(c)], corners[size_t(c + 1) % 3]);
        }
        if (level == 0) continue;
        const int steps = aperturaLatticeSteps(level);
        const auto first = uint32_t(vertices + faces->first[t]);
        for (int sample = 0; sample < aperturaLatticeSize(steps); ++sample) {
            const uint32_t point = first + uint32_t(sample);
            const glm::vec3 weights = latticePoint(sample, steps);
            places_[point] = {int(t), weights};
            for (size_t c = 0; c < 3; ++c) {
                at[point] += double(weights[int(c)]) * glm::dvec3(surface.positions[corners[c]]);
                normal[point] += weights[int(c)] * surface.normals[corners[c]];
            }
        }
        forLatticeEdges(steps, [&](int a, int b) { edges.emplace_back(first + uint32_t(a), first + uint32_t(b)); });
    }
    std::vector<uint32_t> order(at.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto key = [&](uint32_t p) { return std::tuple(at[p].x, at[p].y, at[p].z); };
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return std::tuple(key(a), a) < std::tuple(key(b), b); });
    twin_.resize(at.size());
    for (size_t begin = 0, end; begin < order.size(); begin = end) {
        std::vector<uint32_t> firsts;
        for (end = begin; end < order.size() && key(order[end]) == key(order[begin]); ++end) {
            const uint32_t point = order[end];
            twin_[point] = point;
            if (places_[point].triangle < 0) continue;  // vertices that nothing draws are twins of none
            const auto same = std::find_if(firsts.begin(), firsts.end(), [&](uint32_t f) {
                return dot(normal[f], normal[point]) >= kTwinCosine * length(normal[f]) * length(normal[point]);
            });
            if (same == firsts.end())
                firsts.push_back(point);
            else
                twin_[point] = *same;
        }
    }
    for (auto& [from, to] : edges) from = twin_[from], to = twin_[to];
    neighbours_ = Neighbours(at.size(), std::move(edges));
}

}  // namespace apertura
