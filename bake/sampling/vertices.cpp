#include "apertura/bake/sampling/vertices.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>

#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/sampling/progress.h"
#include "apertura/bake/sampling/solids.h"

namespace apertura {
namespace {

using glm::dvec3;

constexpr int kSuspicious = 4;    // where so many of Solids::kProbes rays see backs of faces, other points are tried
constexpr double kBetter = 0.25;  // and one is taken that sees no more than this fraction of those backs
constexpr double kSteps[] = {0.02, 0.1, 0.25, 0.5, 0.75, 1};  // fractions of the way to the middle of a triangle or an edge
constexpr double kNoArea = 1e-10;  // a triangle has no area up to this ratio of its area to its squared longest edge
constexpr double kLarge = 0.05;    // a large triangle's longest edge, as a fraction of the scene's size
constexpr double kSteep = 0.1;     // cosine below which a normal hardly leads away from a face

// A summary of the triangles about one vertex.
struct Corner {
    int count = 0;          // triangles that have an area
    dvec3 faces{0};         // sum of their normals, weighted by angle, on the side of their vertices' normals
    dvec3 within{0};        // sum of the directions to their middles
    double longest = 0;     // the longest edge, metres
    double middle = 1e300;  // metres to the nearest of their middles
};

// One instance's triangles, in the world.
class Mesh {
public:
    Mesh(const Scene& scene, const Instance& instance) : surface_(scene.surfaces[instance.surface]) {
        for (const glm::vec3& p : surface_.positions) places_.push_back(worldPosition(instance, p));
        const glm::mat3 turn = normalMatrix(instance.toWorld);
        for (const glm::vec3& n : surface_.normals) {
            const dvec3 world(turn * n);
            const double length = glm::length(world);
            normals_.push_back(length > 0 ? world / length : dvec3(0, 1, 0));
        }
        first_.assign(places_.size() + 1, 0);
        for (const auto& t : surface_.triangles)
            for (uint32_t v : t) ++first_[v + 1];
        for (size_t v = 0; v < places_.size(); ++v) first_[v + 1] += first_[v];
        around_.resize(first_.back());
        std::vector<size_t> next(first_.begin(), first_.end() - 1);
        for (size_t t = 0; t < surface_.triangles.size(); ++t)
            for (uint32_t v : surface_.triangles[t]) around_[next[v]++] = t;
        mirrored_ = glm::determinant(glm::dmat3(instance.toWorld)) < 0;
    }

    size_t size() const { return places_.size(); }
    bool used(size_t v) const { return first_[v + 1] > first_[v]; }
    const dvec3& place(size_t v) const { return places_[v]; }
    const dvec3& normal(size_t v) const { return normals_[v]; }
    size_t inverted() const {  // triangles wound opposite to their vertices' normals; mirroring reverses winding
        size_t n = 0;
        for (size_t t = 0; t < surface_.triangles.size(); ++t) n += hasArea(t) && (sideOf(t) < 0) != mirrored_;
        return n;
    }
    size_t degenerate() const {
        size_t n = 0;
        for (size_t t = 0; t < surface_.triangles.size(); ++t) n += !hasArea(t);
        return n;
    }

    size_t longerThan(double length) const {
        size_t n = 0;
        for (size_t t = 0; t < surface_.triangles.size(); ++t) n += longest(t) > length;
        return n;
    }

    Corner corner(size_t v) const {
        Corner out;
        for (size_t i = first_[v]; i < first_[v + 1]; ++i) {
            const size_t t = around_[i];
            out.longest = std::max(out.longest, longest(t));
            if (!hasArea(t)) continue;
            const auto [a, b] = edges(t, v);
            const dvec3 n = glm::cross(a, b);
            ++out.count;
            out.middle = std::min(out.middle, glm::length(a + b) / 3);
            out.faces += sideOf(t) * glm::normalize(n) * std::atan2(glm::length(n), glm::dot(a, b));
            out.within += glm::normalize(a + b);
        }
        return out;
    }

    // The least and the largest cosine between `direction` and the normals of the faces about a vertex.
    std::pair<double, double> cosines(size_t v, const dvec3& direction) const {
        std::pair<double, double> out{1, -1};
        for (size_t i = first_[v]; i < first_[v + 1]; ++i)
            if (hasArea(around_[i])) {
                const double c = sideOf(around_[i]) * glm::dot(glm::normalize(crossOf(around_[i])), direction);
                out = {std::min(out.first, c), std::max(out.second, c)};
            }
        return out;
    }

    // Points of the vertex's triangles to start rays from instead, nearest first.
    std::vector<dvec3> others(size_t v) const {
        std::vector<dvec3> out;
        for (size_t i = first_[v]; i < first_[v + 1]; ++i) {
            if (!hasArea(around_[i])) continue;
            const auto [a, b] = edges(around_[i], v);
            for (const double step : kSteps)
                for (const dvec3& way : {(a + b) / 3.0, 0.45 * a + 0.05 * b, 0.05 * a + 0.45 * b, 0.475 * (a + b)})
                    out.push_back(places_[v] + step * way);
        }
        std::stable_sort(out.begin(), out.end(),
                         [&](const dvec3& a, const dvec3& b) { return glm::distance(a, places_[v]) < glm::distance(b, places_[v]); });
        return out;
    }

private:
    dvec3 crossOf(size_t t) const {
        const auto& i = surface_.triangles[t];
        return glm::cross(places_[i[1]] - places_[i[0]], places_[i[2]] - places_[i[0]]);
    }
    // 1 where a triangle's vertex normals point to the front of its winding or lie in its plane, -1 where they point to
    // the back.
    double sideOf(size_t t) const {
        const auto& i = surface_.triangles[t];
        return glm::dot(crossOf(t), normals_[i[0]] + normals_[i[1]] + normals_[i[2]]) < 0 ? -1 : 1;
    }
    double longest(size_t t) const {
        const auto& i = surface_.triangles[t];
        return std::max({glm::distance(places_[i[0]], places_[i[1]]), glm::distance(places_[i[1]], places_[i[2]]),
                         glm::distance(places_[i[2]], places_[i[0]])});
    }
    bool hasArea(size_t t) const { return glm::length(crossOf(t)) > 2 * kNoArea * longest(t) * longest(t); }
    // From a vertex to the other two of its triangle, in winding order.
    std::pair<dvec3, dvec3> edges(size_t t, size_t v) const {
        const auto& i = surface_.triangles[t];
        const int k = i[0] == v ? 0 : i[1] == v ? 1 : 2;
        return {places_[i[(k + 1) % 3]] - places_[v], places_[i[(k + 2) % 3]] - places_[v]};
    }

    const Surface& surface_;
    std::vector<dvec3> places_, normals_;
    std::vector<size_t> first_, around_;  // triangles about each vertex
    bool mirrored_ = false;
};

// The diagonal of the box about a scene's triangles, metres.
double diagonalOf(const Scene& scene) {
    dvec3 low(std::numeric_limits<double>::max()), high = -low;
    for (const Instance& instance : scene.instances) {
        const Surface& surface = scene.surfaces[instance.surface];
        for (const auto& t : surface.triangles)
            for (uint32_t v : t) {
                const dvec3 place = worldPosition(instance, surface.positions[v]);
                low = glm::min(low, place), high = glm::max(high, place);
            }
    }
    return glm::length(high - low);
}

// The normal to bake a vertex along: its own, or the mean of its faces' normals where its own points behind all of them.
dvec3 outward(const Mesh& mesh, size_t v, const Corner& corner, bool& isBehind) {
    const auto [least, most] = mesh.cosines(v, mesh.normal(v));
    isBehind = corner.count > 0 && most < -1e-3 && glm::length(corner.faces) > 1e-6;
    return isBehind ? glm::normalize(corner.faces) : mesh.normal(v);
}

// A point one rounding step above all of the vertex's faces and inside them, minus what rayOrigin adds along the normal.
SurfacePoint nextTo(const Mesh& mesh, const Tracer& tracer, size_t v, const Corner& corner, const dvec3& normal) {
    dvec3 up = normal;
    if (const double least = mesh.cosines(v, normal).first; least < kSteep && glm::length(corner.faces) > 1e-6) {
        const dvec3 other = glm::normalize(corner.faces);
        if (mesh.cosines(v, other).first > least) up = other;
    }
    const double step = tracer.offset(mesh.place(v), corner.longest);
    dvec3 within = corner.within - glm::dot(corner.within, up) * up;
    within *= std::min(1.0, 0.25 * corner.middle / step) / std::max(glm::length(within), 1.0);
    // Where faces rise towards their middles, there is less room inside them.
    for (int halved = 0; halved < 6 && mesh.cosines(v, up + within).first < kSteep; ++halved) within *= halved < 5 ? 0.5 : 0.0;
    return {mesh.place(v) + step * (up - normal + within), glm::vec3(normal), corner.longest};
}

}  // namespace

std::vector<std::string> describe(const MeshIssues& d) {
    std::vector<std::string> out;
    auto say = [&](const char* what, size_t count, const char* then) {
        if (count > 0) out.push_back(std::string(what) + ": " + std::to_string(count) + " (" + then + ")");
    };
    say("triangles of no area", d.degenerate, "they block nothing");
    say("vertices of no other triangles", d.withoutFaces, "baked along the normals they have");
    say("triangles wound against their surface's normals", d.inverted, "the normals are believed");
    say("vertices with normals behind all of their faces", d.normalsBehind, "baked on the faces' side");
    say("vertices inside other geometry", d.moved, "baked from the nearest point outside on their triangles");
    say("triangles longer than a twentieth of the scene", d.large, "shadows that fall within them are lost: --at faces keeps them");
    say("vertices that see backs of faces", d.insideSolids,
        "baked as they are: right inside solids; where they show as dark spots, faces are one-sided or inside out");
    return out;
}

VertexPoints placeVertices(const Scene& scene, const Tracer& tracer, const Progress& progress, MeshIssues* issues) {
    VertexPoints out;
    MeshIssues sum;
    size_t all = 0;
    const Solids solids(scene, tracer);
    const double large = kLarge * diagonalOf(scene);
    for (const Instance& instance : scene.instances) all += scene.surfaces[instance.surface].positions.size();
    ProgressCounter counter(progress, all);
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Mesh mesh(scene, scene.instances[i]);
        sum.degenerate += mesh.degenerate();
        sum.inverted += mesh.inverted();
        sum.large += mesh.longerThan(large);
        std::vector<size_t> vertices;
        for (size_t v = 0; v < mesh.size(); ++v)
            if (mesh.used(v)) vertices.push_back(v);
        std::vector<SurfacePoint> points(vertices.size());
        std::atomic<size_t> withoutFaces = 0, normalsBehind = 0, moved = 0, insideSolids = 0;
        tbb::parallel_for(tbb::blocked_range<size_t>(0, vertices.size(), 64), [&](const tbb::blocked_range<size_t>& range) {
            if (counter.stopped()) return;
            for (size_t k = range.begin(); k < range.end(); ++k) {
                const size_t v = vertices[k];
                const Corner corner = mesh.corner(v);
                bool isBehind = false;
                const dvec3 normal = outward(mesh, v, corner, isBehind);
                normalsBehind += isBehind;
                withoutFaces += corner.count == 0;
                points[k] = nextTo(mesh, tracer, v, corner, normal);
                const double spin = 2 * std::numbers::pi * hashUnit(0, i, v);
                const int backs = solids.backsSeen(points[k], spin);
                if (backs < kSuspicious) continue;
                bool found = false;
                for (const dvec3& other : mesh.others(v)) {
                    const SurfacePoint candidate{other, glm::vec3(normal), corner.longest};
                    if (!solids.comesOut(points[k], candidate) || solids.backsSeen(candidate, spin) > kBetter * backs) continue;
                    points[k] = candidate;
                    found = true;
                    break;
                }
                ++(found ? moved : insideSolids);
            }
            counter.add(range.size());
        });
        counter.throwIfStopped();
        sum.withoutFaces += withoutFaces, sum.normalsBehind += normalsBehind, sum.moved += moved, sum.insideSolids += insideSolids;
        for (size_t v : vertices) out.places.emplace_back(i, v);
        out.points.insert(out.points.end(), points.begin(), points.end());
    }
    if (issues) *issues = sum;
    return out;
}

}  // namespace apertura
