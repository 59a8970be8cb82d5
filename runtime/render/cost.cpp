#include "apertura/runtime/render/cost.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <string_view>

#include "apertura/runtime/render/draw.h"
#include "apertura/runtime/render/materials.h"
#include "apertura/runtime/render/scene_shaders.h"
#include "apertura/sh/models.h"
#include "cost.comp.h"
#include "shadow.frag.h"
#include "shadow0.vert.h"

namespace apertura {
namespace {

GpuBindings makeBindings(const Gpu& gpu, const GpuBuffer* points, const GpuBuffer* results, const GpuBuffer* light) {
    constexpr auto compute = vk::ShaderStageFlagBits::eCompute;
    const GpuBindings::Binding bindings[] = {{vk::DescriptorType::eStorageBuffer, compute, points},
                                             {vk::DescriptorType::eStorageBuffer, compute, results},
                                             {vk::DescriptorType::eUniformBuffer, compute, light}};
    return {gpu, bindings};
}

std::vector<vk::raii::Pipeline> makePipelines(const Gpu& gpu, std::span<const CostCase> cases, const GpuBindings& bindings,
                                              vk::PipelineCreateFlags flags) {
    std::vector<vk::raii::Pipeline> out;
    for (const CostCase& c : cases) {
        const int32_t constants[] = {c.model, c.lightClass, models()[size_t(c.model)].slots, c.sky};
        out.push_back(makeComputePipeline(gpu, cost_comp, constants, bindings, flags));
    }
    return out;
}

// Receivers of all kinds, so that the branches of a formula are taken and cost something.
GpuBuffer makePoints(const Gpu& gpu, int points) {
    std::vector<vec4> values(size_t(points) * (2 + APERTURA_MAX_SLOTS));
    for (size_t i = 0; i < values.size(); ++i) {
        const float a = float(i * 2654435761u % 1000) / 1000;
        values[i] = vec4(std::sin(9 * a), std::cos(9 * a), 0.3f, 0.1f + 0.8f * a);
    }
    return upload(gpu, std::as_bytes(std::span(values)), vk::BufferUsageFlagBits::eStorageBuffer);
}

// The sine of a radius typical of the class.
float typicalSize(int lightClass) {
    return lightClass == APERTURA_LIGHTS_SUN    ? 0.00465f
         : lightClass == APERTURA_LIGHTS_SMALL  ? 0.0436f
         : lightClass == APERTURA_LIGHTS_MEDIUM ? 0.087f
                                                : 0.259f;
}

// Reads the compiler's statistics of one stage of a pipeline.
CompiledCost read(const Gpu& gpu, vk::Pipeline pipeline, vk::ShaderStageFlagBits stage) {
    const vk::raii::Device& device = gpu.handles().device;
    CompiledCost out;
    const auto executables = device.getPipelineExecutablePropertiesKHR({.pipeline = pipeline});
    for (uint32_t i = 0; i < executables.size(); ++i) {
        if (!(executables[i].stages & stage)) continue;
        for (const auto& s : device.getPipelineExecutableStatisticsKHR({.pipeline = pipeline, .executableIndex = i})) {
            const std::string_view name = s.name.data();
            const int value = int(s.value.u64);
            if (name == "Inverse Throughput") out.cycles = value;
            if (name == "Instructions") out.instructions = value;
            if (name == "Latency") out.latency = value;
            if (name == "VGPRs") out.registers = value;
        }
    }
    if (out.cycles == 0) throw Error("Vulkan: " + gpu.name() + " states no inverse throughput");
    return out;
}

// Times commands by the device's clock.
class Stopwatch {
public:
    explicit Stopwatch(const Gpu& gpu)
        : gpu_(gpu),
          pool_(make<vk::raii::QueryPool>(gpu, vk::QueryPoolCreateInfo{.queryType = vk::QueryType::eTimestamp, .queryCount = 2})) {
        if (gpu.clockTick() <= 0) throw Error("Vulkan: " + gpu.name() + " has no clock for its commands");
    }
    template <class Record>
    double seconds(const Record& record) const {
        gpu_.run([&](vk::CommandBuffer commands) {
            commands.resetQueryPool(*pool_, 0, 2);
            commands.writeTimestamp2(vk::PipelineStageFlagBits2::eAllCommands, *pool_, 0);
            record(commands);
            commands.writeTimestamp2(vk::PipelineStageFlagBits2::eAllCommands, *pool_, 1);
        });
        const auto ticks = checked([&] {
            return pool_
                .getResults<uint64_t>(0, 2, 2 * sizeof(uint64_t), sizeof(uint64_t),
                                      vk::QueryResultFlagBits::e64 | vk::QueryResultFlagBits::eWait)
                .second;
        });
        return std::max(double(ticks[1] - ticks[0]), 1.0) * gpu_.clockTick();
    }

private:
    const Gpu& gpu_;
    vk::raii::QueryPool pool_;
};

}  // namespace

std::vector<CompiledCost> compiledCosts(const Gpu& gpu, std::span<const CostCase> cases) {
    const GpuBindings bindings = makeBindings(gpu, nullptr, nullptr, nullptr);
    std::vector<CompiledCost> out;
    for (const auto& pipeline : makePipelines(gpu, cases, bindings, vk::PipelineCreateFlagBits::eCaptureStatisticsKHR))
        out.push_back(checked([&] { return read(gpu, *pipeline, vk::ShaderStageFlagBits::eCompute); }));
    return out;
}

std::vector<CompiledCost> compiledPixelCosts(const Gpu& gpu, std::span<const PixelCase> cases) {
    constexpr auto uniform = vk::DescriptorType::eUniformBufferDynamic, storage = vk::DescriptorType::eStorageBuffer;
    constexpr vk::ShaderStageFlags both = vk::ShaderStageFlagBits::eVertex | vk::ShaderStageFlagBits::eFragment;
    const GpuBindings::Binding lit[] = {{uniform, both, nullptr}, {storage, both, nullptr}, {storage, both, nullptr},
                                        {storage, both, nullptr}, {storage, both, nullptr}, {storage, both, nullptr},
                                        {storage, both, nullptr}, {storage, both, nullptr}, {storage, both, nullptr}};
    const GpuBindings::Binding mapped[] = {{uniform, both, nullptr}, {storage, both, nullptr},
                                           {storage, both, nullptr}, {uniform, both, nullptr},
                                           {storage, both, nullptr}, {vk::DescriptorType::eSampledImage, both, nullptr}};
    const vk::raii::DescriptorSetLayout materials = Materials::makeLayout(gpu);
    const GpuBindings bindings(gpu, lit, *materials), mapBindings(gpu, mapped, *materials);
    constexpr auto capture = vk::PipelineCreateFlagBits::eCaptureStatisticsKHR;
    constexpr auto format = vk::Format::eR8G8B8A8Srgb;
    std::vector<CompiledCost> out;
    const auto compile = [&](const DrawShaders& shaders, const GpuBindings& with) {
        const vk::raii::Pipeline pipeline = makePipeline(gpu, shaders, with, format, capture);
        return checked([&] { return read(gpu, *pipeline, vk::ShaderStageFlagBits::eFragment); });
    };
    // Compilers guess how often a loop runs, and Mesa guesses 8: what a corner costs is counted once and taken three times, and the cost of
    // the shadow map's taps four times, for 32.
    const auto times = [](CompiledCost cost, const CompiledCost& without, int factor) {
        cost.cycles += (factor - 1) * (cost.cycles - without.cycles);
        cost.instructions += (factor - 1) * (cost.instructions - without.instructions);
        return cost;
    };
    static_assert(APERTURA_SHADOW_TAPS == 4 * 8);
    // What a pixel that reads its samples itself pays beside them, by class, faces, paint and bounces.
    struct Shared {
        CompiledCost plain;  // N.L
        CompiledCost rest;   // where the sky's light comes from and what bounces, once for all corners
    };
    std::map<std::tuple<int, bool, bool, int>, Shared> known;
    for (const PixelCase& c : cases) {
        const auto withModel = [&](const Model& model, Corners corners, int bounces) {
            const int32_t constants[] = {model.id, c.lightClass, model.slots, c.onFaces, false, c.painted, 0, true, bounces};
            return compile({sceneVertex(corners), sceneFragment(corners, true), constants}, bindings);
        };
        const std::tuple key(c.lightClass, c.onFaces, c.painted, c.bounces);
        if (!known.contains(key)) {
            const Model& occlusion = *findModel("ao-area");
            Shared& shared = known[key];
            shared.plain = withModel(*findModel("unshadowed"), Corners::Mixed, APERTURA_BOUNCES_NONE);
            // A model that mixes, as it is and counted by its corners: the rest.
            const CompiledCost whole = withModel(occlusion, Corners::Mixed, c.bounces),
                               corners = times(withModel(occlusion, Corners::One, APERTURA_BOUNCES_NONE), shared.plain, 3);
            shared.rest.cycles = std::max(whole.cycles - corners.cycles, 0);
            shared.rest.instructions = std::max(whole.instructions - corners.instructions, 0);
        }
        const Shared& shared = known[key];
        if (!c.model) {
            const int32_t constants[] = {c.painted, 0};
            out.push_back(times(compile({shadow0_vert, shadow_frag, constants}, mapBindings), shared.plain, 4));
        } else if (c.at == LightAt::Vertices) {
            const int32_t constants[] = {c.model->id, 0, c.lightClass, c.painted, 0, c.bounces};
            out.push_back(compile({lit_vert, lit_frag, constants}, bindings));
        } else if (c.model->mixes) {
            out.push_back(withModel(*c.model, cornersFor(*c.model, c.onFaces), c.bounces));
        } else {
            CompiledCost cost = times(withModel(*c.model, Corners::One, APERTURA_BOUNCES_NONE), shared.plain, 3);
            cost.cycles += shared.rest.cycles;
            cost.instructions += shared.rest.instructions;
            out.push_back(cost);
        }
    }
    return out;
}

std::vector<double> measuredCosts(const Gpu& gpu, std::span<const CostCase> cases, int points, int rounds) {
    const GpuBuffer receivers = makePoints(gpu, points);
    const GpuBuffer results(gpu, size_t(points) * sizeof(float), vk::BufferUsageFlagBits::eStorageBuffer, GpuBuffer::Place::Device);
    const GpuBuffer lightBuffer(gpu, sizeof(AperturaLight), vk::BufferUsageFlagBits::eUniformBuffer, GpuBuffer::Place::Host);
    const GpuBindings bindings = makeBindings(gpu, &receivers, &results, &lightBuffer);
    const std::vector<vk::raii::Pipeline> pipelines = makePipelines(gpu, cases, bindings, {});
    const Stopwatch stopwatch(gpu);
    std::vector<double> least(cases.size(), 1e30);
    for (int round = 0; round < rounds; ++round)
        for (size_t i = 0; i < cases.size(); ++i) {
            const AperturaLight light{aperturaCapLight(vec3(0.6f, 0.64f, 0.48f), typicalSize(cases[i].lightClass)), vec4(0), vec4(1),
                                      vec4(0), ivec4(0)};
            std::memcpy(lightBuffer.data(), &light, sizeof light);
            least[i] = std::min(least[i], stopwatch.seconds([&](vk::CommandBuffer commands) {
                commands.bindPipeline(vk::PipelineBindPoint::eCompute, *pipelines[i]);
                bindings.bind(commands, vk::PipelineBindPoint::eCompute);
                commands.dispatch(uint32_t(points / 64), 1, 1);
            }));
        }
    return least;
}

std::vector<double> measuredFrames(const Gpu& gpu, const View& view, std::span<const FrameCase> cases, int rounds) {
    constexpr auto format = VK_FORMAT_R8G8B8A8_SRGB;
    const Offscreen images(gpu, {uint32_t(view.width), uint32_t(view.height)}, vk::Format(format));
    const Stopwatch stopwatch(gpu);
    for (const FrameCase& c : cases) {
        if (c.model)
            c.renderer->prepare(*c.model, lightClassOf(view), format, c.at, int(view.lights.size()), c.renderer->bouncesOf(view));
        else
            c.renderer->prepareShadowMapped(format);
    }
    gpu.run([&](VkCommandBuffer commands) { images.begin(commands); });
    std::vector<double> least(cases.size(), 1e30);
    for (int round = 0; round < rounds; ++round)
        for (size_t i = 0; i < cases.size(); ++i) {
            const FrameCase& c = cases[i];
            least[i] = std::min(least[i], stopwatch.seconds([&](VkCommandBuffer commands) {
                if (c.model)
                    c.renderer->record(commands, images.target(), view, *c.model, 0, c.at);
                else
                    c.renderer->recordShadowMapped(commands, images.target(), view, 0);
            }));
        }
    return least;
}

}  // namespace apertura
