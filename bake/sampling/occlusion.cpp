#include "apertura/bake/sampling/occlusion.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <numbers>
#include <optional>

#include "apertura/bake/sampling/directions.h"

namespace apertura {
namespace {

// Every third bit of a number, from its lowest 10.
uint32_t spread(uint32_t x) {
    uint32_t out = 0;
    for (uint32_t bit = 0; bit < 10; ++bit) out |= (x >> bit & 1) << 3 * bit;
    return out;
}

// The points in an order in which neighbours lie close together: Morton, "A Computer Oriented Geodetic Data Base", 1966.
std::vector<uint32_t> alongCurve(std::span<const SurfacePoint> points) {
    glm::dvec3 low(1e300), high(-1e300);
    for (const SurfacePoint& p : points) low = glm::min(low, p.position), high = glm::max(high, p.position);
    const double size = std::max({high.x - low.x, high.y - low.y, high.z - low.z, 1e-300});
    std::vector<std::pair<uint32_t, uint32_t>> keyed;
    keyed.reserve(points.size());
    for (size_t i = 0; i < points.size(); ++i) {
        const glm::dvec3 at = (points[i].position - low) / size * 1023.0;
        keyed.emplace_back(spread(uint32_t(at.x)) | spread(uint32_t(at.y)) << 1 | spread(uint32_t(at.z)) << 2, uint32_t(i));
    }
    std::sort(keyed.begin(), keyed.end());
    std::vector<uint32_t> out;
    out.reserve(points.size());
    for (const auto& [key, i] : keyed) out.push_back(i);
    return out;
}

}  // namespace

void samplePoints(const OcclusionSource& source, std::span<const SurfacePoint> points, const SampleLattice& lattice, uint32_t seed,
                  int threads, const Progress& progress, const std::function<void(size_t, const Samples&, const glm::mat3&)>& use) {
    std::optional<tbb::global_control> limit;
    if (threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, size_t(threads));
    // Points that are close together meet the same triangles.
    const std::vector<uint32_t> order = alongCurve(points);
    ProgressCounter counter(progress, points.size());
    tbb::parallel_for(tbb::blocked_range<size_t>(0, points.size(), 8), [&](const tbb::blocked_range<size_t>& range) {
        std::vector<glm::vec3> directions(lattice.directions().size());
        std::vector<uint8_t> blocked(directions.size());
        for (size_t k = range.begin(); k < range.end() && !counter.stopped(); ++k) {
            const size_t i = order[k];
            const glm::mat3 frame = frameFromZ(points[i].normal, 2 * std::numbers::pi * hashUnit(seed, i, 0));
            for (size_t d = 0; d < directions.size(); ++d) directions[d] = frame * lattice.directions()[d];
            source.occluded(points[i], directions, blocked.data());
            Samples samples(lattice, blocked);
            samples.source = &source;
            samples.point = &points[i];
            use(i, samples, frame);
            counter.add(1);
        }
    });
    counter.throwIfStopped();
}

}  // namespace apertura
