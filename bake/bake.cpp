#include "bake/bake.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "bake/watch.h"

namespace apertura {
namespace {

constexpr double kPi = std::numbers::pi;

// Halves a list of directions at the median of their longest axis until a packet of rays is left.
void orderForPackets(std::span<glm::vec3> directions) {
    if (directions.size() <= 16) return;
    glm::vec3 low(2), high(-2);
    for (const glm::vec3& d : directions) low = glm::min(low, d), high = glm::max(high, d);
    const glm::vec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const size_t half = (directions.size() / 2 + 15) / 16 * 16;
    std::nth_element(directions.begin(), directions.begin() + ptrdiff_t(half), directions.end(),
                     [axis](const glm::vec3& a, const glm::vec3& b) { return a[axis] < b[axis]; });
    orderForPackets(directions.first(half));
    orderForPackets(directions.subspan(half));
}

}  // namespace

double hashUnit(uint32_t seed, uint64_t a, uint64_t b) {
    // SplitMix64's finaliser (Steele, Lea and Flood, "Fast splittable pseudorandom number generators", 2014).
    uint64_t x = (uint64_t(seed) + 1) * 0x9E3779B97F4A7C15ull + a * 0xD1B54A32D192ED03ull + b * 0x8CB92BA72F3D8DD7ull;
    for (int round = 0; round < 2; ++round) {
        x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
        x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
        x ^= x >> 31;
    }
    return double(x >> 11) * 0x1p-53;
}

glm::mat3 frameAbout(const glm::vec3& normal, double angle) {
    // Duff et al., "Building an Orthonormal Basis, Revisited", 2017.
    const float sign = std::copysign(1.0f, normal.z), a = -1 / (sign + normal.z), b = normal.x * normal.y * a;
    const glm::vec3 u(1 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
    const glm::vec3 v(b, sign + normal.y * normal.y * a, -normal.y);
    const float c = float(std::cos(angle)), s = float(std::sin(angle));
    return {c * u + s * v, c * v - s * u, normal};
}

std::vector<glm::vec3> capLattice(int n, double h) {
    // Fibonacci's lattice: even steps of height, turned by the golden angle.
    const double golden = kPi * (3 - std::sqrt(5.0));
    std::vector<glm::vec3> out;
    for (int i = 0; i < n; ++i) {
        const double down = h * (i + 0.5) / n, s = std::sqrt(down * (2 - down)), turn = std::fmod(golden * i, 2 * kPi);
        out.emplace_back(float(s * std::cos(turn)), float(s * std::sin(turn)), float(1 - down));
    }
    return out;
}

std::vector<glm::vec3> hemisphereLattice(int n) {
    std::vector<glm::vec3> out = capLattice(n, 1);
    orderForPackets(out);
    return out;
}

std::vector<Visibility> bakePoints(const Tracer& tracer, std::span<const SurfacePoint> points,
                                   const BakeOptions& options, const Progress& progress) {
    std::optional<tbb::global_control> limit;
    if (options.threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, size_t(options.threads));

    const std::vector<glm::vec3> lattice = hemisphereLattice(options.rays);
    const double solidAngle = 2 * kPi / options.rays;
    const float distance = options.maxDistance > 0 ? float(options.maxDistance) : kNoLimit;
    std::vector<Visibility> out(points.size());
    Watch watch(progress, points.size());
    tbb::parallel_for(tbb::blocked_range<size_t>(0, points.size(), 64), [&](const tbb::blocked_range<size_t>& range) {
        if (watch.stopped()) return;
        std::vector<glm::vec3> directions(lattice.size()), open;
        std::vector<uint8_t> blocked(lattice.size());
        for (size_t i = range.begin(); i < range.end(); ++i) {
            const SurfacePoint& point = points[i];
            const glm::mat3 frame = frameAbout(point.normal, 2 * kPi * hashUnit(options.seed, i, 0));
            for (size_t k = 0; k < lattice.size(); ++k) directions[k] = frame * lattice[k];
            tracer.occluded(point.position + tracer.offset() * point.normal, directions, distance, blocked.data());
            if (options.model == BakeModel::Sh) {
                open.clear();
                for (size_t k = 0; k < lattice.size(); ++k)
                    if (!blocked[k]) open.push_back(directions[k]);
                out[i] = toVisibility(project(open, solidAngle));
            } else {
                int count = 0;
                glm::dvec3 sum(0);
                for (size_t k = 0; k < lattice.size(); ++k)
                    if (!blocked[k]) ++count, sum += glm::dvec3(directions[k]);
                out[i] = {glm::vec3(sum * solidAngle), float(count * solidAngle)};
            }
        }
        watch.add(range.size());
    });
    watch.throwIfStopped();
    return out;
}

BakedVisibility bakeVertices(const Scene& scene, const Tracer& tracer, const BakeOptions& options,
                             const Progress& progress) {
    std::vector<SurfacePoint> points;
    std::vector<std::pair<size_t, size_t>> places;  // instance, vertex
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const Surface& surface = scene.surfaces[instance.surface];
        std::vector<bool> used(surface.positions.size());
        for (const auto& triangle : surface.triangles)
            for (uint32_t v : triangle) used[v] = true;
        const glm::mat3 normals = normalMatrix(instance.toWorld);
        for (size_t v = 0; v < used.size(); ++v) {
            if (!used[v]) continue;
            const glm::vec3 n = normals * surface.normals[v];
            const float length = glm::length(n);
            points.push_back({glm::vec3(instance.toWorld * glm::vec4(surface.positions[v], 1)),
                              length > 0 ? n / length : glm::vec3(0, 1, 0)});
            places.emplace_back(i, v);
        }
    }
    const std::vector<Visibility> baked = bakePoints(tracer, points, options, progress);
    BakedVisibility out;
    for (const Instance& instance : scene.instances)
        out.emplace_back(scene.surfaces[instance.surface].positions.size());
    for (size_t k = 0; k < baked.size(); ++k) out[places[k].first][places[k].second] = baked[k];
    return out;
}

}  // namespace apertura
