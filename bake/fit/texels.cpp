#include "apertura/bake/fit/texels.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apertura/bake/fit/face_unknowns.h"
#include "apertura/bake/fit/least_squares.h"
#include "apertura/bake/sampling/classes.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/png.h"
#include "apertura/runtime/asset/tangents.h"
#include "apertura/runtime/asset/texels.h"

namespace apertura {
namespace {

constexpr double kProbesATexel = 3;
constexpr double kFewestProbes = 2;     // of a triangle
constexpr float kTie = 0.03f;           // how strongly neighbouring texels of a chart are drawn together, where a probe's weight is 1
constexpr float kStitch = 16;           // and the two sides of an edge where charts meet, at each of the points along it
constexpr double kStitches = 2;         // points along such an edge, a texel
constexpr double kMostOverlap = 0.001;  // of what the triangles cover
constexpr double kNoPlace = 1e-6;       // texels that a triangle covers when it has no place in the image,
constexpr double kMostWithout = 0.001;  // and the fraction of the surface that may be so
constexpr double kBytesFitted = 450, kBytesKept = 40;  // a texel takes while its image is fitted, and then
constexpr float kSame = 1e-6f;                         // texture coordinates that are the same

glm::ivec2 sizeFor(const Surface& surface, int side) { return surface.grid.x > 0 ? surface.grid : glm::ivec2(side); }

struct Texels {
    const Scene& scene;
    size_t instance;
    const Surface& surface;
    glm::ivec2 size;
    TexelMap map;
    std::vector<uint32_t> charts;  // of each triangle, a number

    Texels(const Scene& scene_, size_t instance_, int side)
        : scene(scene_),
          instance(instance_),
          surface(scene_.surfaces[size_t(scene_.instances[instance_].surface)]),
          size(sizeFor(surface, side)),
          map(mapTexels(surface, size.x, size.y)) {
        Classes classes(surface.positions.size());
        for (const auto& t : surface.triangles)
            for (size_t c = 1; c < 3; ++c) classes.join(t[0], t[c]);
        for (const auto& t : surface.triangles) charts.push_back(classes.find(t[0]));
    }

    // In texels.
    double areaOf(size_t t) const {
        const auto& c = surface.triangles[t];
        const glm::dvec2 a = surface.coordinates[c[1]] - surface.coordinates[c[0]],
                         b = surface.coordinates[c[2]] - surface.coordinates[c[0]];
        return 0.5 * std::abs(a.x * b.y - a.y * b.x) * size.x * size.y;
    }
    size_t probesOn(size_t t) const { return size_t(std::ceil(std::max(kFewestProbes, kProbesATexel * areaOf(t)))); }
};

// Adds `weight` times the texels about a point of a triangle.
void addPoint(std::vector<Term>& terms, const Surface& surface, size_t t, const glm::vec3& barycentrics, const glm::ivec2& size,
              float weight) {
    const AperturaTexelCell cell = texelCell(surface, t, barycentrics, size.x, size.y);
    for (int c = 0; c < 4; ++c) {
        const auto texel = uint32_t(cell.texels[c]);
        const auto found = std::find_if(terms.begin(), terms.end(), [&](const Term& term) { return term.first == texel; });
        if (found == terms.end())
            terms.emplace_back(texel, weight * cell.weights[c]);
        else
            found->second += weight * cell.weights[c];
    }
}

glm::vec3 along(int e, float s) {
    glm::vec3 out(0);
    out[e] = 1 - s, out[(e + 1) % 3] = s;
    return out;
}

// Where two triangles meet smoothly on the surface and not in the image, the two sides of their edge are to be the same.
void stitch(LeastSquares& equations, const Texels& texels) {
    const Surface& surface = texels.surface;
    std::vector<bool> leans;
    for (size_t t = 0; t < surface.triangles.size(); ++t)
        leans.push_back(surfaceAt(texels.scene, int(texels.instance), int(t), glm::vec3(1 / 3.0f)).leans);
    const Unknowns unknowns(texels.scene, texels.instance, std::vector<uint8_t>(surface.triangles.size(), 0), leans);
    for (size_t t = 0; t < surface.triangles.size(); ++t)
        for (int e = 0; e < 3; ++e) {
            const int64_t other = unknowns.across(t, e);
            if (other < int64_t(t)) continue;
            // The other triangle's edge between the same two places.
            const auto place = [&](size_t triangle, int corner) {
                return surface.positions[surface.triangles[triangle][size_t(corner % 3)]];
            };
            for (int f = 0; f < 3; ++f) {
                const bool backwards = place(size_t(other), f) == place(t, e + 1) && place(size_t(other), f + 1) == place(t, e);
                const bool forwards = place(size_t(other), f) == place(t, e) && place(size_t(other), f + 1) == place(t, e + 1);
                if (!backwards && !forwards) continue;
                const auto here = [&](float s) { return along(e, s); };
                const auto there = [&](float s) { return along(f, backwards ? 1 - s : s); };
                const auto apart = [&](float s) {
                    return glm::distance(coordinatesAt(surface, t, here(s)), coordinatesAt(surface, size_t(other), there(s)));
                };
                if (apart(0) < kSame && apart(1) < kSame) break;
                const float length = glm::distance(coordinatesAt(surface, t, here(0)), coordinatesAt(surface, t, here(1)))
                                   * float(std::max(texels.size.x, texels.size.y));
                const int points = int(std::ceil(kStitches * length)) + 1;
                for (int k = 0; k <= points; ++k) {
                    const float s = float(k) / float(points);
                    std::vector<Term> terms;
                    addPoint(terms, surface, t, here(s), texels.size, 1);
                    addPoint(terms, surface, size_t(other), there(s), texels.size, -1);
                    equations.close(terms, kStitch);
                }
                break;
            }
        }
}

using Probes = std::vector<std::vector<Probe>>;  // of each triangle of an instance

Probes lookAt(const Texels& texels, const Prober& prober, ProgressCounter& counter) {
    Probes out(texels.surface.triangles.size());
    tbb::parallel_for(tbb::blocked_range<size_t>(0, out.size(), 16), [&](const tbb::blocked_range<size_t>& range) {
        if (counter.stopped()) return;
        for (size_t t = range.begin(); t < range.end(); ++t)
            for (size_t k = 0, n = texels.probesOn(t); k < n; ++k) out[t].push_back(prober.probe(texels.instance, t, k));
        counter.add(range.size());
    });
    counter.throwIfStopped();
    return out;
}

// Equations for an image: valueOf(triangle, probe) at each probe that is not buried, and texels of a chart that are drawn together.
LeastSquares equationsFor(const Texels& texels, const Probes& probes, const auto& valueOf) {
    const TexelMap& map = texels.map;
    LeastSquares equations(map.texels.size());
    for (size_t t = 0; t < probes.size(); ++t)
        for (const Probe& probe : probes[t]) {
            if (probe.buried) continue;
            std::vector<Term> terms;
            addPoint(terms, texels.surface, t, probe.weights, texels.size, 1);
            equations.add(terms, valueOf(t, probe));
        }
    const auto chart = [&](size_t at) { return texels.charts[size_t(map.texels[at].triangle)]; };
    const auto [width, height] = std::pair(texels.size.x, texels.size.y);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const auto at = uint32_t(y * width + x);
            for (const auto& [inside, next] : {std::pair(x + 1 < width, at + 1), {y + 1 < height, at + uint32_t(width)}})
                if (inside && map.isDrawn[at] && map.isDrawn[next] && chart(at) == chart(next)) equations.tie(at, next, kTie);
        }
    return equations;
}

// How many texels triangles of two charts read.
size_t sharedTexels(const Texels& texels, const Probes& probes) {
    std::vector<uint32_t> chartOf(texels.map.texels.size(), UINT32_MAX);
    std::vector<bool> isShared(texels.map.texels.size(), false);
    for (size_t t = 0; t < probes.size(); ++t)
        for (const Probe& probe : probes[t]) {
            std::vector<Term> terms;
            addPoint(terms, texels.surface, t, probe.weights, texels.size, 1);
            for (const Term& term : terms) {
                uint32_t& chart = chartOf[term.first];
                isShared[term.first] = isShared[term.first] || (chart != UINT32_MAX && chart != texels.charts[t]);
                chart = texels.charts[t];
            }
        }
    return size_t(std::count(isShared.begin(), isShared.end(), true));
}

void fitVisibility(const Texels& texels, const Probes& probes, SeenByInstance& out, const Scene& scene) {
    LeastSquares equations = equationsFor(texels, probes, [](size_t, const Probe& probe) { return probe.mean(); });
    stitch(equations, texels);
    const std::vector<Visibility> fitted = equations.solve();
    out.texels = {texels.size.x, texels.size.y, {}, {}, 8};
    for (const uint32_t from : texels.map.from) out.texels.visibility.push_back(fitted[from]);
    setTexelNormals(scene, texels.instance, texels.map, out.texels);
}

// Both are fitted to what engines decode: the unit bent normal in the frame of the tangents, which differs where charts meet, so that
// occlusion alone is stitched.
void fitBentNormals(const Texels& texels, const Probes& probes, SeenByInstance& out, const Scene& scene) {
    std::vector<glm::vec4> toStore;
    const Tangents tangents = tangentsOf(scene, texels.instance, &toStore);
    const glm::mat3 toLocal = glm::transpose(rotationPart(scene.instances[texels.instance].toWorld));
    // One after the other, as either takes much memory.
    const std::vector<glm::vec4> directions = equationsFor(texels, probes, [&](size_t t, const Probe& probe) {
                                                  const float length = glm::length(probe.bent);
                                                  if (length <= 0) return glm::vec4(0, 0, 1, 0);
                                                  const glm::mat3 frame = tangentFrame(texels.surface, tangents, t, probe.weights);
                                                  return glm::vec4(glm::transpose(frame) * toLocal * (probe.bent / length), 0);
                                              }).solveFreely();
    LeastSquares open = equationsFor(texels, probes, [](size_t, const Probe& probe) {
        return glm::vec4(0, 0, 0, glm::dot(probe.mean().direction, probe.normal) / std::numbers::pi_v<float>);
    });
    stitch(open, texels);
    const std::vector<glm::vec4> occlusion = open.solveFreely();
    out.bent = {texels.size.x, texels.size.y, {}, std::move(toStore)};
    for (const uint32_t from : texels.map.from) {
        glm::vec3 d(directions[from]);
        d.z = std::max(d.z, 0.0f);  // engines that store x and y alone make z positive
        const float length = glm::length(d);
        out.bent.texels.emplace_back(length > 0 ? d / length : glm::vec3(0, 0, 1), std::clamp(occlusion[from].w, 0.0f, 1.0f));
    }
}

}  // namespace

void requireCharts(const Scene& scene, int side) {
    double most = 0, all = 0;  // texels of one instance, and of all
    for (const Instance& instance : scene.instances) {
        const glm::ivec2 size = sizeFor(scene.surfaces[size_t(instance.surface)], side);
        most = std::max(most, double(size.x) * size.y);
        all += double(size.x) * size.y;
    }
    requireMemory(scene.name, "its images", kBytesFitted * most + kBytesKept * all);
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const Surface& surface = scene.surfaces[size_t(instance.surface)];
        const std::string where = scene.name + ": mesh " + std::to_string(instance.surface);
        if (surface.coordinates.size() != surface.positions.size())
            throw Error(where + " has no texture coordinates, over which an image could lie");
        const glm::ivec2 size = sizeFor(surface, side);
        if (std::max(size.x, size.y) > kLargestPng)
            throw Error(where + ": its image would have more than " + std::to_string(kLargestPng) + " texels a side");
        requireMappable(surface, size.x, size.y, where);
        // Points of a grid, each strictly inside of how many triangles.
        const glm::ivec2 n = 2 * size;
        std::vector<uint8_t> inside(size_t(n.x) * size_t(n.y), 0);
        for (const auto& t : surface.triangles) {
            const glm::dvec2 a = glm::dvec2(surface.coordinates[t[0]]) * glm::dvec2(n),
                             b = glm::dvec2(surface.coordinates[t[1]]) * glm::dvec2(n),
                             c = glm::dvec2(surface.coordinates[t[2]]) * glm::dvec2(n);
            const auto cross = [](const glm::dvec2& u, const glm::dvec2& v) { return u.x * v.y - u.y * v.x; };
            const double area = cross(b - a, c - a);
            if (area == 0) continue;
            const auto first = [](double x) { return std::max(0, int(std::floor(x - 0.5))); };
            const auto last = [](double x, int count) { return std::min(count - 1, int(std::ceil(x))); };
            for (int y = first(std::min({a.y, b.y, c.y})); y <= last(std::max({a.y, b.y, c.y}), n.y); ++y)
                for (int x = first(std::min({a.x, b.x, c.x})); x <= last(std::max({a.x, b.x, c.x}), n.x); ++x) {
                    const glm::dvec2 p(x + 0.5, y + 0.5);
                    if (std::min({cross(c - b, p - b) / area, cross(a - c, p - c) / area, cross(b - a, p - a) / area}) <= 1e-6) continue;
                    uint8_t& count = inside[size_t(y) * size_t(n.x) + size_t(x)];
                    count = uint8_t(std::min(count + 1, 2));
                }
        }
        double area = 0, without = 0;
        for (size_t t = 0; t < surface.triangles.size(); ++t) {
            const std::array<glm::dvec3, 3> c = cornersOf(scene, int(i), int(t));
            const auto& v = surface.triangles[t];
            const glm::dvec2 a = surface.coordinates[v[1]] - surface.coordinates[v[0]],
                             b = surface.coordinates[v[2]] - surface.coordinates[v[0]];
            const double own = glm::length(glm::cross(c[1] - c[0], c[2] - c[0]));
            area += own;
            if (std::abs(a.x * b.y - a.y * b.x) * size.x * size.y <= kNoPlace) without += own;
        }
        const auto percent = [](double share) {
            char text[32];
            std::snprintf(text, sizeof text, "%.3g", 100 * share);
            return std::string(text);
        };
        if (without > kMostWithout * area)
            throw Error(where + ": " + percent(without / area)
                        + " % of its surface has no place in the image: coordinates that are all the same");
        const auto once = double(inside.size() - size_t(std::count(inside.begin(), inside.end(), 0)));
        const auto twice = double(std::count(inside.begin(), inside.end(), 2));
        if (twice > kMostOverlap * once)
            throw Error(where + ": " + percent(twice / once)
                        + " % of what its triangles cover in the image is covered twice; each needs a place of its own");
    }
}

TexelReport bakeTexels(const Scene& scene, const Prober& prober, int side, As as, BakedVisibility& out, const Progress& progress) {
    TexelReport report;
    size_t triangles = 0, shared = 0;
    for (const Instance& instance : scene.instances) triangles += scene.surfaces[size_t(instance.surface)].triangles.size();
    ProgressCounter counter(progress, std::max<size_t>(triangles, 1));
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Texels texels(scene, i, side);
        const Probes probes = lookAt(texels, prober, counter);
        if (as == As::Visibility)
            fitVisibility(texels, probes, out[i], scene);
        else
            fitBentNormals(texels, probes, out[i], scene);
        throwIfStopped(progress, 1);
        ++report.images;
        report.texels += texels.map.texels.size();
        report.drawn += texels.map.drawn();
        shared += sharedTexels(texels, probes);
    }
    report.shared = double(shared) / std::max(double(report.drawn), 1.0);
    return report;
}

}  // namespace apertura
