#include "apertura/bake/measure/fuzz.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apertura/bake/fit/choose.h"
#include "apertura/bake/sampling/directions.h"

namespace apertura {

FuzzInput fuzzInput(const Model& model, uint32_t seed, uint64_t index) {
    uint64_t draw = 0;
    auto unit = [&] { return hashUnit(seed, index, 1 + draw++); };
    auto among = [&](std::initializer_list<float> values) { return values.begin()[size_t(unit() * double(values.size()))]; };
    auto direction = [&] { return vec3(tilted(std::acos(1 - 2 * unit()), 2 * std::numbers::pi * unit())); };
    auto corner = [&] { return vec3(among({-1, 0, 1}), among({-1, 0, 1}), among({0, 1})); };
    auto axis = [&](const vec3& other) {
        const double kind = unit();
        if (kind < 0.5) return direction();
        if (kind < 0.6) return other;
        if (kind < 0.7) return -other;
        if (kind < 0.8) return vec3(among({0.0f, -0.0f}), among({0.0f, 1.0f, -1.0f}), 0.0f);
        if (kind < 0.9) return direction() * among({0.9995f, 1.0005f, 1e-20f, 1e-4f, 30.0f, 1e10f});
        return corner();
    };
    FuzzInput out;
    const vec3 normal = unit() < 0.8 ? direction() : axis(direction());
    const vec3 light = axis(normal);
    const float sine = unit() < 0.6 ? float(std::pow(10, -5 * unit()))
                                    : among({0.0f, 1e-30f, 1e-8f, 1e-4f, 0.00465f, 0.0105f, 0.0524f, 0.1737f, 0.7071f, 1.0f});
    auto params = [&] {
        const float pi = std::numbers::pi_v<float>;
        const float area = unit() < 0.6 ? float(2 * std::numbers::pi * unit())
                                        : among({0.0f, 1e-38f, 1e-9f, 1e-4f, pi, 2 * pi, 6.2831860f, 7.0f, 4 * pi, 1e30f, -1.0f});
        const float share = unit() < 0.5 ? float(unit()) : among({0.0f, 1.0f, 1.0001f, 1e-6f, 10.0f});
        const Visibility v{axis(unit() < 0.5 ? normal : light) * std::clamp(area * (1 - area / (4 * pi)) * share, -1e30f, 1e30f), area};
        const Model* stored = &model;
        if (model.kind == ModelKind::Choice) stored = autoModels()[size_t(unit() * double(autoModels().size()))];
        std::vector<float> numbers(size_t(storedNumbers(*stored)) + 1);
        for (float& n : numbers)
            n = unit() < 0.7 ? float(2 * unit() - 1) : among({-1.0f, 1.0f, 0.0f, -0.0f, 1 / 127.0f, -1 / 127.0f, 1e-20f});
        ModelParams raw = unpackParams(*stored, numbers);
        if (model.kind == ModelKind::Choice) setChoice(raw, *stored, false);
        const Visibility possible = clampToPossible(v);
        return toReceiver(possible, toParams(model, v, model.isStored() ? &raw : nullptr, normal), normal);
    };
    out.receiver = params();
    if (model.mixes && unit() < 0.3) {
        const AperturaReceiver other = params();
        const float t = among({0.0f, 0.5f, 0.25f, 1.0f});
        out.receiver.visibility = mix(out.receiver.visibility, other.visibility, t);
        for (int k = 0; k < APERTURA_MAX_SLOTS; ++k) out.receiver.params[k] = mix(out.receiver.params[k], other.params[k], t);
        out.receiver = aperturaRenormalised(model.id, out.receiver);
    }
    out.light = vec4(light, sine);
    out.sound = std::abs(dot(normal, normal) - 1) < 1e-5f && std::abs(dot(light, light) - 1) < 1e-5f;
    return out;
}

FuzzCount countFuzz(const Model& model, uint32_t seed, uint64_t inputs, const FrameEvaluator& device) {
    const uint64_t batch = device ? 1 << 18 : 1 << 14;  // each batch sets the device up anew
    const uint64_t batches = (inputs + batch - 1) / batch;
    std::vector<FuzzCount> counts(batches);
    auto judge = [](FuzzCount& count, float e, const FuzzInput& input) {
        const AperturaCapLight light = aperturaCapLight(vec3(input.light), input.light.w);
        ++count.inputs;
        count.notFinite += !std::isfinite(e);
        count.outside += input.sound
                      && (e < -1e-6f * light.area
                          || e > 1.006f * aperturaUnoccludedIrradiance(input.receiver.normal, light, APERTURA_LIGHTS_ANY)
                                     + kAboveOne * light.area);
    };
    auto onProcessor = [&](uint64_t b) {
        for (uint64_t i = b * batch; i < std::min(inputs, (b + 1) * batch); ++i) {
            const FuzzInput input = fuzzInput(model, seed, i);
            judge(counts[b],
                  aperturaIrradianceThrough(model.id, input.receiver, aperturaCapLight(vec3(input.light), input.light.w),
                                            lightClassOf(input.light.w)),
                  input);
        }
    };
    auto onDevice = [&](uint64_t b) {
        std::vector<FuzzInput> all[4];
        std::vector<AperturaEvaluation> frames[4];
        for (uint64_t i = b * batch; i < std::min(inputs, (b + 1) * batch); ++i) {
            const FuzzInput input = fuzzInput(model, seed, i);
            const auto lightClass = size_t(lightClassOf(input.light.w));
            AperturaEvaluation e{vec4(input.receiver.normal, 0), input.light, input.receiver.visibility, {}};
            std::copy_n(input.receiver.params, APERTURA_MAX_SLOTS, e.params);
            frames[lightClass].push_back(e);
            all[lightClass].push_back(input);
        }
        for (size_t lightClass = 0; lightClass < 4; ++lightClass) {
            if (frames[lightClass].empty()) continue;
            const std::vector<float> found = device(model.id, int(lightClass), frames[lightClass]);
            for (size_t i = 0; i < found.size(); ++i) judge(counts[b], found[i], all[lightClass][i]);
        }
    };
    if (device)
        for (uint64_t b = 0; b < batches; ++b) onDevice(b);
    else
        tbb::parallel_for(uint64_t(0), batches, onProcessor);
    FuzzCount sum;
    for (const FuzzCount& c : counts) sum.inputs += c.inputs, sum.notFinite += c.notFinite, sum.outside += c.outside;
    return sum;
}

}  // namespace apertura
