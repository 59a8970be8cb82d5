// Speeds, as ratios within one run wherever a machine would matter. Run by hand: build/release/tests/bench
#include <benchmark/benchmark.h>

#include <random>

#include "bake/load.h"
#include "bake/receivers.h"
#include "sh/packing.h"
#include "sh/vertex_visibility.h"

#include <oneapi/tbb/global_control.h>

namespace apertura {
namespace {

struct Statue {
    Scene scene = makeBuiltin("statue");
    Tracer tracer{scene};
    std::vector<SurfacePoint> points;
    Statue() {
        for (const SpreadPoint& p : spreadReceivers(scene, 4000, 1)) points.push_back(p.at);
    }
};

const Statue& statue() {
    static const Statue s;
    return s;
}

// The baker, one thread.
void Bake(benchmark::State& state) {
    BakeOptions options;
    options.threads = 1;
    for (auto _ : state) benchmark::DoNotOptimize(bakePoints(statue().tracer, statue().points, options));
    state.counters["rays"] = benchmark::Counter(double(statue().points.size()) * options.rays * double(state.iterations()), benchmark::Counter::kIsRate);
}

// The same rays, made beforehand, through Embree and nothing else.
void BareEmbree(benchmark::State& state) {
    const auto lattice = hemisphereLattice(256);
    std::vector<std::vector<glm::vec3>> rays;
    for (size_t i = 0; i < statue().points.size(); ++i) {
        const glm::mat3 frame = frameAbout(statue().points[i].normal, 6.283185307179586 * hashUnit(1, i, 0));
        rays.emplace_back();
        for (const glm::vec3& w : lattice) rays.back().push_back(frame * w);
    }
    std::vector<uint8_t> blocked(256);
    for (auto _ : state)
        for (size_t i = 0; i < rays.size(); ++i) {
            const SurfacePoint& p = statue().points[i];
            statue().tracer.occluded(p.position + statue().tracer.offset() * p.normal, rays[i], kNoLimit, blocked.data());
            benchmark::DoNotOptimize(blocked.data());
        }
    state.counters["rays"] = benchmark::Counter(double(rays.size()) * 256 * double(state.iterations()), benchmark::Counter::kIsRate);
}

std::vector<Packed8> packed() {
    std::vector<Packed8> out;
    for (const Visibility& v : bakePoints(statue().tracer, statue().points, {})) out.push_back(pack8(v));
    return out;
}

// From the four bytes, as a loader does.
template <typename Convert>
void convertAll(benchmark::State& state, Convert&& convert) {
    const std::vector<Packed8> bytes = packed();
    for (auto _ : state)
        for (size_t i = 0; i < bytes.size(); ++i) benchmark::DoNotOptimize(convert(unpack(bytes[i]), statue().points[i].normal));
    state.counters["vertices"] = benchmark::Counter(double(bytes.size()) * double(state.iterations()), benchmark::Counter::kIsRate);
}
void ToAperture(benchmark::State& state) { convertAll(state, [](const Visibility& v, const vec3& n) { return toAperture(v, n); }); }
void ToSoft(benchmark::State& state) { convertAll(state, [](const Visibility& v, const vec3& n) { return toSoft(v, n); }); }
void ToVertex(benchmark::State& state) { convertAll(state, [](const Visibility& v, const vec3& n) { return toVertex(v, n); }); }

BENCHMARK(Bake)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(BareEmbree)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(ToAperture)->Unit(benchmark::kMillisecond);
BENCHMARK(ToSoft)->Unit(benchmark::kMillisecond);
BENCHMARK(ToVertex)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace apertura

BENCHMARK_MAIN();
