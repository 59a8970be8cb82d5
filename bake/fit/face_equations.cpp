#include "apertura/bake/fit/face_equations.h"

#include "apertura/bake/sampling/neighbours.h"

namespace apertura {
namespace {

constexpr float kVertexWeight = 4;  // of what a vertex itself sees, beside a probe: it has four times the rays

int levelOf(const Face& face, Fitted what) { return what == Fitted::All ? face.level : 0; }

}  // namespace

std::array<Term, 3> termsOf(const AperturaLatticeCell& cell) {
    std::array<Term, 3> out;
    for (int c = 0; c < 3; ++c) out[size_t(c)] = {uint32_t(cell.samples[c]), cell.weights[c]};
    return out;
}

Unknowns unknownsOf(const Scene& scene, size_t instance, std::span<const Face> faces, Fitted what) {
    const size_t triangles = scene.surfaces[size_t(scene.instances[instance].surface)].triangles.size();
    std::vector<uint8_t> levels(triangles, 0);
    std::vector<bool> leans(triangles, false);
    for (const Face& face : faces) levels[face.triangle] = uint8_t(levelOf(face, what)), leans[face.triangle] = face.leans;
    return {scene, instance, std::move(levels), std::move(leans)};
}

LeastSquares equationsOf(const Unknowns& unknowns, std::span<const Face> faces, const Surface& surface, std::span<const Visibility> seen,
                         Fitted what) {
    LeastSquares out(unknowns.count());
    std::vector<bool> used(seen.size(), false);  // a vertex that no triangle has saw nothing
    for (const Face& face : faces)
        for (const uint32_t v : surface.triangles[face.triangle]) used[v] = true;
    for (size_t v = 0; v < seen.size(); ++v)
        if (used[v]) out.add(std::array{Term(unknowns.vertex(v), 1.0f)}, seen[v], kVertexWeight);
    for (const Face& face : faces) {
        const int level = levelOf(face, what);
        if (level == 0 && face.leans) continue;  // its vertices look elsewhere
        for (const Probe& probe : face.probes)
            if (!probe.buried) out.add(unknowns.point(face.triangle, probe.weights), probe.mean());
        const auto tie = [&](int a, int b) {
            const auto from = unknowns.sample(face.triangle, a), to = unknowns.sample(face.triangle, b);
            if (from.size() == 1 && to.size() == 1 && from[0].first != to[0].first) out.tie(from[0].first, to[0].first, face.tie);
        };
        if (level == 0)
            tie(0, 1), tie(1, 2), tie(2, 0);
        else
            forLatticeEdges(aperturaLatticeSteps(level), tie);
    }
    return out;
}

}  // namespace apertura
