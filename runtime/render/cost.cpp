#include "runtime/render/cost.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>

#include "cost.comp.h"
#include "runtime/render/resources.h"
#include "sh/models.h"

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
    std::vector<vec4> values(size_t(points) * (2 + MAX_SLOTS));
    for (size_t i = 0; i < values.size(); ++i) {
        const float a = float(i * 2654435761u % 1000) / 1000;
        values[i] = vec4(std::sin(9 * a), std::cos(9 * a), 0.3f, 0.1f + 0.8f * a);
    }
    return upload(gpu, std::as_bytes(std::span(values)), vk::BufferUsageFlagBits::eStorageBuffer);
}

// The sine of a radius typical of the class.
float typicalSize(int lightClass) {
    return lightClass == LIGHTS_SUN ? 0.00465f : lightClass == LIGHTS_SMALL ? 0.0436f : lightClass == LIGHTS_MEDIUM ? 0.087f : 0.259f;
}

// Reads the compiler's statistics of one pipeline.
CompiledCost read(const Gpu& gpu, vk::Pipeline pipeline) {
    const vk::raii::Device& device = gpu.handles().device;
    CompiledCost out;
    const size_t executables = device.getPipelineExecutablePropertiesKHR({.pipeline = pipeline}).size();
    for (uint32_t i = 0; i < executables; ++i)
        for (const auto& s : device.getPipelineExecutableStatisticsKHR({.pipeline = pipeline, .executableIndex = i})) {
            const std::string_view name = s.name.data();
            const int value = int(s.value.u64);
            if (name == "Inverse Throughput") out.cycles = value;
            if (name == "Instructions") out.instructions = value;
            if (name == "Latency") out.latency = value;
            if (name == "VGPRs") out.registers = value;
        }
    if (out.cycles == 0) throw Error("Vulkan: " + gpu.name() + " states no inverse throughput");
    return out;
}

}  // namespace

std::vector<CompiledCost> compiledCosts(const Gpu& gpu, std::span<const CostCase> cases) {
    const GpuBindings bindings = makeBindings(gpu, nullptr, nullptr, nullptr);
    std::vector<CompiledCost> out;
    for (const auto& pipeline : makePipelines(gpu, cases, bindings, vk::PipelineCreateFlagBits::eCaptureStatisticsKHR))
        out.push_back(checked([&] { return read(gpu, *pipeline); }));
    return out;
}

std::vector<double> measuredCosts(const Gpu& gpu, std::span<const CostCase> cases, int points, int rounds) {
    if (gpu.clockTick() <= 0) throw Error("Vulkan: " + gpu.name() + " has no clock for its commands");
    const GpuBuffer receivers = makePoints(gpu, points);
    const GpuBuffer results(gpu, size_t(points) * sizeof(float), vk::BufferUsageFlagBits::eStorageBuffer, GpuBuffer::Place::Device);
    const GpuBuffer lightBuffer(gpu, sizeof(Light), vk::BufferUsageFlagBits::eUniformBuffer, GpuBuffer::Place::Host);
    const GpuBindings bindings = makeBindings(gpu, &receivers, &results, &lightBuffer);
    const std::vector<vk::raii::Pipeline> pipelines = makePipelines(gpu, cases, bindings, {});
    const auto pool = make<vk::raii::QueryPool>(gpu, vk::QueryPoolCreateInfo{.queryType = vk::QueryType::eTimestamp, .queryCount = 2});
    std::vector<double> least(cases.size(), 1e30);
    for (int round = 0; round < rounds; ++round)
        for (size_t i = 0; i < cases.size(); ++i) {
            const Light light{capLight(vec3(0.6f, 0.64f, 0.48f), typicalSize(cases[i].lightClass)), vec4(0), vec4(1)};
            std::memcpy(lightBuffer.data(), &light, sizeof light);
            gpu.run([&](vk::CommandBuffer commands) {
                commands.resetQueryPool(*pool, 0, 2);
                commands.writeTimestamp2(vk::PipelineStageFlagBits2::eAllCommands, *pool, 0);
                commands.bindPipeline(vk::PipelineBindPoint::eCompute, *pipelines[i]);
                bindings.bind(commands, vk::PipelineBindPoint::eCompute);
                commands.dispatch(uint32_t(points / 64), 1, 1);
                commands.writeTimestamp2(vk::PipelineStageFlagBits2::eAllCommands, *pool, 1);
            });
            const auto ticks = checked([&] {
                return pool
                    .getResults<uint64_t>(0, 2, 2 * sizeof(uint64_t), sizeof(uint64_t),
                                          vk::QueryResultFlagBits::e64 | vk::QueryResultFlagBits::eWait)
                    .second;
            });
            least[i] = std::min(least[i], std::max(double(ticks[1] - ticks[0]), 1.0) * gpu.clockTick());
        }
    return least;
}

}  // namespace apertura
