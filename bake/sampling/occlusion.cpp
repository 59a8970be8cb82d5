#include "apertura/bake/sampling/occlusion.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#include <numbers>
#include <optional>

#include "apertura/bake/sampling/directions.h"

namespace apertura {

void samplePoints(const OcclusionSource& source, std::span<const SurfacePoint> points, const SampleLattice& lattice, uint32_t seed,
                  int threads, const Progress& progress, const std::function<void(size_t, const Samples&, const glm::mat3&)>& use) {
    std::optional<tbb::global_control> limit;
    if (threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, size_t(threads));
    ProgressCounter counter(progress, points.size());
    tbb::parallel_for(tbb::blocked_range<size_t>(0, points.size(), 8), [&](const tbb::blocked_range<size_t>& range) {
        std::vector<glm::vec3> directions(lattice.directions().size());
        std::vector<uint8_t> blocked(directions.size());
        for (size_t i = range.begin(); i < range.end() && !counter.stopped(); ++i) {
            const glm::mat3 frame = frameFromZ(points[i].normal, 2 * std::numbers::pi * hashUnit(seed, i, 0));
            for (size_t k = 0; k < directions.size(); ++k) directions[k] = frame * lattice.directions()[k];
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
