// Speeds of the sweep, as ratios within one run: of the Andes where $APERTURA_SCENES has them, else of mountains of noise.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <cstdlib>
#include <filesystem>
#include <numbers>

#include "apertura/bake/sampling/horizons.h"
#include "apertura/bake/sampling/occlusion.h"
#include "apertura/bake/scene/height_map.h"
#include "apertura/bake/scene/height_mesh.h"
#include "tests/mountains.h"

namespace apertura {
namespace {

using std::numbers::pi;

constexpr int kAzimuths = 16, kFewestRays = 64, kTrueRays = 4096;
constexpr size_t kPoints = 4000;

HeightField map() {
    const char* const scenes = std::getenv("APERTURA_SCENES");
    const std::filesystem::path andes = std::filesystem::path(scenes ? scenes : "") / "dem/andes_S33W071_srtm3_1201.tif";
    return std::filesystem::exists(andes) ? loadHeights(andes, {}).field : test::mountains(1201, 1201, 78, 92, 200, 1500);
}

// Of all threads of this process, seconds.
double processorTime() {
    rusage used{};
    getrusage(RUSAGE_SELF, &used);
    const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
    return seconds(used.ru_utime) + seconds(used.ru_stime);
}

double processorTimeOf(const auto& work) {
    const double start = processorTime();
    work();
    return processorTime() - start;
}

struct Seen {
    std::vector<double> area;
    std::vector<glm::dvec3> direction;
};

// RMS of area / 2 pi, and of the angle between the directions, degrees.
std::pair<double, double> errorOf(const Seen& seen, const Seen& truth) {
    double areas = 0, angles = 0;
    for (size_t i = 0; i < seen.area.size(); ++i) {
        areas += std::pow((seen.area[i] - truth.area[i]) / (2 * pi), 2);
        const double cosine = glm::dot(glm::normalize(seen.direction[i]), glm::normalize(truth.direction[i]));
        angles += std::pow(std::acos(std::min(cosine, 1.0)) * 180 / pi, 2);
    }
    const double count = double(seen.area.size());
    return {std::sqrt(areas / count), std::sqrt(angles / count)};
}

// The sweep against as many rays as err as much, both against 4096: errors, and processor time a texel.
void SweepAgainstRays(benchmark::State& state) {
    const HeightField field = map();
    const Scene scene = terrainScene("map", {fullMesh(field)});
    const Surface& surface = scene.surfaces[0];
    const Tracer tracer(scene);
    const RayOcclusion source(tracer);
    std::vector<SurfacePoint> points;
    std::vector<size_t> texels;
    for (uint64_t i = 0; i < kPoints; ++i) {
        const size_t v = size_t(hashUnit(1, i, 0) * double(surface.positions.size()));
        points.push_back({glm::dvec3(surface.positions[v]), surface.normals[v], 4 * std::max(field.spacingX, field.spacingZ)});
        const glm::vec2 at = surface.coordinates[v] * glm::vec2(surface.grid);
        texels.push_back(size_t(at.y) * size_t(field.width) + size_t(at.x));
    }
    const auto trace = [&](int rays) {
        const SampleLattice lattice(rays);
        Seen out{std::vector<double>(kPoints), std::vector<glm::dvec3>(kPoints)};
        samplePoints(source, points, lattice, 1, 0, {}, [&](size_t i, const Samples& samples, const glm::mat3& frame) {
            for (size_t k = 0; k < lattice.directions().size(); ++k)
                if (samples.isOpen(k))
                    out.area[i] += lattice.solidAngle(),
                        out.direction[i] += lattice.solidAngle() * glm::dvec3(frame * lattice.directions()[k]);
        });
        return out;
    };
    const Seen truth = trace(kTrueRays);
    for (auto _ : state) {
        Seen swept;
        OpenSky sky;
        // 8 azimuths hardly ever reach .004, and 16 nearly always.
        const double sweep = processorTimeOf([&] { sky = openSky(field, 0.0045, {}); }) / double(field.texels());
        for (const size_t t : texels) swept.area.push_back(sky.area[t]), swept.direction.push_back(sky.direction[t]);
        const auto [area, direction] = errorOf(swept, truth);
        // As many rays as err no more in area, between powers of two by their law; the direction's error follows.
        double rays = 0, areaOfRays = 0, directionOfRays = 0, count = 0;
        for (int n = kFewestRays, last = 0; n < kTrueRays; last = n, n *= 2) {
            Seen byRays;
            const double time = processorTimeOf([&] { byRays = trace(n); }) / double(kPoints);
            const auto [a, d] = errorOf(byRays, truth);
            const double share = last == 0 || a > area ? 1 : std::log(areaOfRays / area) / std::log(areaOfRays / a);
            rays = rays + share * (time - rays), count = last * std::pow(double(n) / std::max(last, 1), share);
            if (last == 0) count = n;
            directionOfRays = directionOfRays + (last == 0 ? 1 : share) * (d - directionOfRays);
            areaOfRays = last == 0 ? a : areaOfRays * std::pow(a / areaOfRays, share);
            if (a <= area) break;
        }
        state.counters["azimuths"] = sky.azimuths;
        state.counters["rays"] = count;
        state.counters["area_rms"] = area;
        state.counters["area_rms_rays"] = areaOfRays;
        state.counters["axis_deg"] = direction;
        state.counters["axis_deg_rays"] = directionOfRays;
        state.counters["us_texel"] = 1e6 * sweep;
        state.counters["us_texel_rays"] = 1e6 * rays;
        state.counters["times_faster"] = rays / sweep;
    }
}

// Processor time a texel and azimuth, microseconds: of a sweep by 64 azimuths less one by 16, so that what is done once does not count, of
// all of one by 16, and of exact horizons.
void HorizonsATexel(benchmark::State& state) {
    const HeightField field = map();
    const auto horizons = [&](bool isExact) {
        std::vector<double> azimuths;
        for (int k = 0; k < kAzimuths; ++k) azimuths.push_back(2 * pi * k / kAzimuths);
        HorizonOptions options;
        options.isExact = isExact;
        return processorTimeOf([&] { findHorizons(field, azimuths, options, [](size_t, int, std::span<const float>) {}); });
    };
    for (auto _ : state) {
        int few = 0;
        const double some = processorTimeOf([&] { few = openSky(field, 0.0045, {}).azimuths; });
        const double all = processorTimeOf([&] { openSky(field, 0, {}); });
        const double each = 1e6 / double(field.texels());
        state.counters["sweep_us"] = each * (all - some) / (kMostAzimuths - few);
        state.counters["sweep_all_us"] = each * some / few;
        state.counters["horizons_us"] = each * horizons(false) / kAzimuths;
        state.counters["exact_us"] = each * horizons(true) / kAzimuths;
    }
}

BENCHMARK(SweepAgainstRays)->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK(HorizonsATexel)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
}  // namespace apertura
