// Speeds, as ratios within one run where they depend on the machine. Run by hand: build/release/tests/bench
#include <benchmark/benchmark.h>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <numbers>

#include "apertura/bake/fit/bake.h"
#include "apertura/bake/measure/truth.h"
#include "apertura/bake/sampling/directions.h"
#include "apertura/bake/sampling/surface_points.h"
#include "apertura/bake/scene/load.h"
#include "apertura/runtime/asset/asset.h"
#include "apertura/runtime/asset/view.h"
#include "apertura/runtime/render/cost.h"
#include "apertura/sh/aperture.h"
#include "apertura/sh/packing.h"
#include "apertura/sh/soft.h"

namespace apertura {
namespace {

struct Statue {
    Scene scene = makeBuiltin("statue");
    Tracer tracer{scene};
    std::vector<SurfacePoint> points;
    Statue() {
        for (const SurfaceSample& p : sampleReceivers(scene, 4000, 1)) points.push_back(p.at);
    }
};

const Statue& statue() {
    static const Statue s;
    return s;
}

double seconds(auto&& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// The baker on one thread, in turn with Embree alone on the same rays in prepared packets.
void BakeAgainstBareEmbree(benchmark::State& state) {
    const Surface& surface = statue().scene.surfaces[0];
    RTCDevice device = rtcNewDevice(nullptr);
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto fill = [mesh](RTCBufferType type, RTCFormat format, const void* data, size_t count) {
        std::memcpy(rtcSetNewGeometryBuffer(mesh, type, 0, format, 12, count), data, 12 * count);
    };
    fill(RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, surface.positions.data(), surface.positions.size());
    fill(RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, surface.triangles.data(), surface.triangles.size());
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(scene, mesh);
    rtcCommitScene(scene);

    const auto lattice = fibonacciHemisphere(256);
    std::vector<RTCRay16> packets;
    for (size_t i = 0; i < statue().points.size(); ++i) {
        const SurfacePoint& p = statue().points[i];
        const glm::mat3 frame = frameFromZ(p.normal, 2 * std::numbers::pi * hashUnit(1, i, 0));
        const glm::vec3 o = rayOrigin(statue().tracer, p);
        for (size_t k = 0; k < lattice.size(); k += 16) {
            RTCRay16& r = packets.emplace_back();
            for (size_t lane = 0; lane < 16; ++lane) {
                const glm::vec3 d = frame * lattice[k + lane];
                r.org_x[lane] = o.x, r.org_y[lane] = o.y, r.org_z[lane] = o.z, r.tnear[lane] = 0;
                r.dir_x[lane] = d.x, r.dir_y[lane] = d.y, r.dir_z[lane] = d.z, r.tfar[lane] = kNoLimit;
                r.time[lane] = 0, r.mask[lane] = ~0u, r.id[lane] = 0, r.flags[lane] = 0;
            }
        }
    }
    alignas(64) int valid[16];
    std::fill(std::begin(valid), std::end(valid), -1);
#if RTC_VERSION_MAJOR >= 4
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
    auto trace = [&](RTCRay16& rays) { rtcOccluded16(valid, scene, &rays, &arguments); };
#else
    RTCIntersectContext arguments;
    rtcInitIntersectContext(&arguments);
    arguments.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    auto trace = [&](RTCRay16& rays) { rtcOccluded16(valid, scene, &arguments, &rays); };
#endif
    BakeOptions options;
    options.threads = 1;
    double baking = 0, bare = 0;
    for (auto _ : state) {
        baking += seconds([&] { benchmark::DoNotOptimize(bakePoints(RayOcclusion(statue().tracer), statue().points, options)); });
        bare += seconds([&] {
            for (const RTCRay16& packet : packets) {
                RTCRay16 rays = packet;  // the query writes its answer into them
                trace(rays);
                benchmark::DoNotOptimize(rays.tfar);
            }
        });
    }
    rtcReleaseGeometry(mesh);
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
    const double rays = double(packets.size()) * 16 * double(state.iterations());
    state.counters["baker_rays_per_s"] = rays / baking;
    state.counters["bare_rays_per_s"] = rays / bare;
    state.counters["share"] = bare / baking;
}

std::vector<Packed8> packed() {
    std::vector<Packed8> out;
    for (const BakedPoint& p : bakePoints(RayOcclusion(statue().tracer), statue().points, {})) out.push_back(pack8(p.visibility));
    return out;
}

// Converts from the four bytes, as a loader does.
template <typename Convert>
void convertAll(benchmark::State& state, Convert&& convert) {
    const std::vector<Packed8> bytes = packed();
    for (auto _ : state)
        for (size_t i = 0; i < bytes.size(); ++i) benchmark::DoNotOptimize(convert(unpack(bytes[i]), statue().points[i].normal));
    state.counters["vertices"] = benchmark::Counter(double(bytes.size()) * double(state.iterations()), benchmark::Counter::kIsRate);
}
void ToAperture(benchmark::State& state) {
    convertAll(state, [](const Visibility& v, const vec3& n) { return toAperture(v, n); });
}
void ToSoft(benchmark::State& state) {
    convertAll(state, [](const Visibility& v, const vec3& n) { return toSoft(v, n); });
}

// Speed of a recipe on points of six scenes with 256 rays each: points per second on one core, of the fastest pass.
// Models.FitsAreNoWorse* in model_test.cpp compares the errors of two lobes with those of a long search, for soft steps, for
// firm ones and for steps as hard as caps, with the options that two hard edges are fitted with.
void Fit(benchmark::State& state, const char* name) {
    const FitTools tools(256);
    std::vector<Samples> samples;
    for (const char* scene : {"terrain", "room-3", "canyon", "colonnade", "forest", "statue"}) {
        const Scene made = makeBuiltin(scene);
        const Tracer tracer(made);
        std::vector<SurfacePoint> points;
        for (const SurfaceSample& p : sampleReceivers(made, 60, 3)) points.push_back(p.at);
        std::vector<std::unique_ptr<Samples>> each(points.size());
        samplePoints(RayOcclusion(tracer), points, tools.lattice, 1, 1, {},
                     [&](size_t i, const Samples& s, const glm::mat3&) { each[i] = std::make_unique<Samples>(s); });
        for (const auto& one : each) samples.push_back(*one);
    }
    const Recipe& recipe = *findRecipe(name);
    double least = 1e30;
    for (auto _ : state)
        least = std::min(least, seconds([&] {
                             for (const Samples& s : samples) benchmark::DoNotOptimize(recipe.make(tools, s, glm::mat3(1), {}));
                         }));
    state.counters["points_per_s"] = double(samples.size()) / least;
}

// A frame of a baked file as `render` draws 960 x 540 pixels, four samples each: the time of light at vertices over that of light at
// pixels. $APERTURA_FRAME names the file, $APERTURA_SUN the sun's radius in degrees.
void FrameLitAtVertices(benchmark::State& state) {
    const char* const file = std::getenv("APERTURA_FRAME");
    if (!file) return state.SkipWithError("APERTURA_FRAME names no baked file");
    const Asset asset = loadAsset(file);
    const Model* model = storedModel(asset.info);
    if (!model) model = findModel("soft");
    const Gpu gpu;
    Renderer renderer(gpu, asset);
    View view;
    view.width *= 2, view.height *= 2;
    view.camera = viewOf(asset.scene);
    const char* const degrees = std::getenv("APERTURA_SUN");
    view.lights = {directionalLight({0.5f, 0.6f, 0.5f}, (degrees ? std::atof(degrees) : 0.27) * std::numbers::pi / 180, vec3(1))};
    const FrameCase cases[] = {
        {&renderer, model, LightAt::Pixels}, {&renderer, model, LightAt::Vertices}, {&renderer, findModel("unshadowed")}};
    for (auto _ : state) {
        const std::vector<double> seconds = measuredFrames(gpu, view, cases, 10);
        state.counters["pixels_ms"] = 1e3 * seconds[0];
        state.counters["vertices_ms"] = 1e3 * seconds[1];
        state.counters["ratio"] = seconds[1] / seconds[0];
        state.counters["unshadowed_ms"] = 1e3 * seconds[2];
    }
}

// A frame of the court in the window, 960 x 540 pixels, over that of N.L alone, for the model that an asset of this recipe is drawn with.
void FrameOverPlain(benchmark::State& state, const char* recipe) {
    Asset asset;
    asset.scene = makeBuiltin("arcade");
    asset.info.model = recipe;
    BakeOptions options;
    options.recipe = recipe;
    options.rays = 64;
    asset.seen = bakeScene(asset.scene, Tracer(asset.scene), options);
    asset.info.at = "faces";
    const Model* const stored = storedModel(asset.info);
    const Model& model = stored ? *stored : *findModel("soft");
    const Gpu gpu;
    Renderer renderer(gpu, asset);
    View view;
    view.camera = viewOf(asset.scene);
    view.lights = {directionalLight({0.5f, 0.6f, 0.5f}, 0.27 * std::numbers::pi / 180, vec3(1e5))};
    const double pixels = double(view.width) * view.height;
    const FrameCase cases[] = {{&renderer, &model, renderer.betterLightAt(model, pixels)}, {&renderer, findModel("unshadowed")}};
    for (auto _ : state) {
        const std::vector<double> seconds = measuredFrames(gpu, view, cases, 20);
        state.counters["frame_ms"] = 1e3 * seconds[0];
        state.counters["plain_ms"] = 1e3 * seconds[1];
        state.counters["ratio"] = seconds[0] / seconds[1];
    }
}

BENCHMARK_CAPTURE(FrameOverPlain, soft, "sh")->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK_CAPTURE(FrameOverPlain, firm_2, "firm-2")->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK_CAPTURE(FrameOverPlain, automatic, "auto")->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK(FrameLitAtVertices)->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK_CAPTURE(Fit, cap_anti, "cap-anti")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Fit, multi_2, "multi-2")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Fit, firm_2, "firm-2")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Fit, soft_2, "soft-2")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Fit, firm_4, "firm-4")->Unit(benchmark::kMillisecond);
BENCHMARK(BakeAgainstBareEmbree)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(ToAperture)->Unit(benchmark::kMillisecond);
BENCHMARK(ToSoft)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace apertura

BENCHMARK_MAIN();
