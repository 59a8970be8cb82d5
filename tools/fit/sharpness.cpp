// How sharp the edges of firm-N are, and their softer ones: two lengths of slopes, of which each point takes the better.
// fits sh/models.h kHardSharpness 60
// fits sh/models.h kSofterSharpness 15
// links fit
// links scene
// links sampling
// links directions
// links asset
// links measure
// links sh
#include <mutex>

#include "apertura/bake/fit/lobe_fit.h"
#include "scene_lights.h"

using namespace apertura;
using namespace apertura::test;

// The error that fits of two lobes minimise, over receivers of the built-in scenes; as baking does, but that the softer length is taken
// where it errs less alone.
double error() {
    static const FitTools tools(1024, FitTools::Use::Fits);
    static const std::vector<Samples> all = [] {
        std::vector<Samples> out;
        std::mutex lock;
        for (const std::string& name : builtinNames()) {
            const Scene scene = makeBuiltin(name);
            const Tracer tracer(scene);
            std::vector<SurfacePoint> points;
            for (const SurfaceSample& p : sampleReceivers(scene, 12, 1)) points.push_back(p.at);
            samplePoints(RayOcclusion(tracer), points, tools.lattice, 1, 0, {}, [&](size_t, const Samples& samples, const glm::mat3&) {
                const std::lock_guard hold(lock);
                out.push_back(samples);
                out.back().source = nullptr, out.back().point = nullptr;
            });
        }
        return out;
    }();
    LobeFitOptions options;
    options.lobes = 2;
    options.sharpness = float(kHardSharpness);
    options.softer = float(kSofterSharpness);
    double sum = 0;
    for (const Samples& samples : all) sum += fitLobes(samples, tools.dictionary, LobeFitSides::Both, options).error;
    return std::sqrt(sum / double(all.size()));
}
