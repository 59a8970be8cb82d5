// Where the light of an opening comes from on average: its cosine-weighted mean direction from D and A, as aperturaOpeningCentroid has it.
// fits shaders/sky.glsl aperturaOpeningCentroid 1.155 2.861 0.742 0.298
// links fit
// links scene
// links sampling
// links directions
// links asset
// links measure
// links sh
#include <mutex>
#include <numbers>

#include "apertura/bake/measure/truth.h"
#include "apertura/bake/sampling/occlusion.h"
#include "apertura/bake/scene/builtin.h"

using namespace apertura;

struct Opening {
    vec3 normal, direction, centroid;
    float area;
};

// Over receivers of the built-in scenes, each weighted by the E that its sky gives, as the sky's error is.
double error() {
    static const std::vector<Opening> all = [] {
        std::vector<Opening> out;
        std::mutex lock;
        constexpr int kRays = 1024;
        const SampleLattice lattice(kRays);
        for (const std::string& name : builtinNames()) {
            const Scene scene = makeBuiltin(name);
            const Tracer tracer(scene);
            std::vector<SurfacePoint> points;
            for (const SurfaceSample& p : sampleReceivers(scene, 200, 1)) points.push_back(p.at);
            samplePoints(RayOcclusion(tracer), points, lattice, 1, 0, {}, [&](size_t i, const Samples& samples, const glm::mat3& frame) {
                std::vector<glm::vec3> directions;
                for (const glm::vec3& w : lattice.directions()) directions.push_back(frame * w);
                std::vector<uint8_t> blocked(directions.size());
                samples.source->occluded(points[i], directions, blocked.data());
                glm::dvec3 direction(0), centroid(0);
                double area = 0;
                for (size_t k = 0; k < directions.size(); ++k) {
                    if (blocked[k]) continue;
                    const glm::dvec3 w = directions[k];
                    direction += w * (2 * std::numbers::pi / kRays);
                    centroid += w * glm::dot(w, glm::dvec3(points[i].normal)) * (2 * std::numbers::pi / kRays);
                    area += 2 * std::numbers::pi / kRays;
                }
                const double open = glm::dot(direction, glm::dvec3(points[i].normal));
                const std::lock_guard hold(lock);
                if (open > 0.005) out.push_back({points[i].normal, direction, centroid / open, float(area)});
            });
        }
        return out;
    }();
    double sum = 0;
    for (const Opening& o : all) {
        const vec3 off = aperturaOpeningCentroid(o.normal, o.direction, o.area) - o.centroid;
        sum += dot(off, off) * std::pow(dot(o.normal, o.direction), 2);
    }
    return std::sqrt(sum / double(all.size()));
}
