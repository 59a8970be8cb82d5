#include "runtime/render/cost.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <string>

#include "cost.comp.h"
#include "runtime/asset/error.h"
#include "sh/models.h"

namespace apertura {
namespace {

// The pipelines of all cases; and buffers of so many points, unless there are to be none.
class CostPipelines {
public:
    CostPipelines(const Gpu& gpu, std::span<const CostCase> cases, int points, VkPipelineCreateFlags flags)
        : gpu_(gpu), shader_(gpu, cost_comp), points_(points) {
        if (points > 0) makeBuffers();
        const GpuBindings::Binding bindings[] = {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_SHADER_STAGE_COMPUTE_BIT, pointBuffer_.get()},
                                                 {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_SHADER_STAGE_COMPUTE_BIT, results_.get()},
                                                 {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, VK_SHADER_STAGE_COMPUTE_BIT, light_.get()}};
        bindings_ = std::make_unique<GpuBindings>(gpu, bindings);
        for (const CostCase& c : cases) {
            const int32_t constants[] = {c.model, c.lightClass, models()[size_t(c.model)].slots, c.sky};
            VkSpecializationMapEntry entries[4];
            for (uint32_t i = 0; i < 4; ++i) entries[i] = {i, uint32_t(i * sizeof(int32_t)), sizeof(int32_t)};
            const VkSpecializationInfo special{4, entries, sizeof constants, constants};
            VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
            info.flags = flags;
            info.stage = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, nullptr, 0, VK_SHADER_STAGE_COMPUTE_BIT,
                          shader_.handle(), "main", &special};
            info.layout = bindings_->layout();
            check(vkCreateComputePipelines(gpu.device(), VK_NULL_HANDLE, 1, &info, nullptr, &pipelines_.emplace_back()),
                  "vkCreateComputePipelines");
        }
    }
    ~CostPipelines() {
        for (VkPipeline pipeline : pipelines_) vkDestroyPipeline(gpu_.device(), pipeline, nullptr);
    }
    CostPipelines(const CostPipelines&) = delete;
    CostPipelines& operator=(const CostPipelines&) = delete;

    VkPipeline pipeline(size_t i) const { return pipelines_[i]; }
    void setLight(float sinRadius) {
        const Light light{capLight(vec3(0.6f, 0.64f, 0.48f), sinRadius), vec4(0), vec4(1)};
        std::memcpy(light_->data(), &light, sizeof light);
    }
    void dispatch(VkCommandBuffer commands, size_t i) const {
        const VkDescriptorSet set = bindings_->set();
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipelines_[i]);
        vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, bindings_->layout(), 0, 1, &set, 0, nullptr);
        vkCmdDispatch(commands, uint32_t(points_ / 64), 1, 1);
    }

private:
    void makeBuffers() {
        // Receivers of all sorts: the cost of a branch shows only where it is taken.
        std::vector<vec4> values(size_t(points_) * (2 + MAX_SLOTS));
        for (size_t i = 0; i < values.size(); ++i) {
            const float a = float(i * 2654435761u % 1000) / 1000;
            values[i] = vec4(std::sin(9 * a), std::cos(9 * a), 0.3f, 0.1f + 0.8f * a);
        }
        pointBuffer_ = upload(gpu_, std::as_bytes(std::span(values)), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
        results_ = std::make_unique<GpuBuffer>(gpu_, size_t(points_) * sizeof(float), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, GpuBuffer::Place::Device);
        light_ = std::make_unique<GpuBuffer>(gpu_, sizeof(Light), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, GpuBuffer::Place::Host);
    }

    const Gpu& gpu_;
    GpuShader shader_;
    int points_;
    std::unique_ptr<GpuBuffer> pointBuffer_, results_, light_;
    std::unique_ptr<GpuBindings> bindings_;
    std::vector<VkPipeline> pipelines_;
};

// The compiler's figures of one pipeline, by their names.
CompiledCost read(const Gpu& gpu, VkPipeline pipeline) {
    const auto properties = reinterpret_cast<PFN_vkGetPipelineExecutablePropertiesKHR>(
        vkGetDeviceProcAddr(gpu.device(), "vkGetPipelineExecutablePropertiesKHR"));
    const auto statistics = reinterpret_cast<PFN_vkGetPipelineExecutableStatisticsKHR>(
        vkGetDeviceProcAddr(gpu.device(), "vkGetPipelineExecutableStatisticsKHR"));
    if (!properties || !statistics) throw Error("Vulkan: " + gpu.name() + " tells nothing of what it compiles");
    const VkPipelineInfoKHR which{VK_STRUCTURE_TYPE_PIPELINE_INFO_KHR, nullptr, pipeline};
    uint32_t executables = 0;
    check(properties(gpu.device(), &which, &executables, nullptr), "vkGetPipelineExecutablePropertiesKHR");
    CompiledCost out;
    for (uint32_t i = 0; i < executables; ++i) {
        const VkPipelineExecutableInfoKHR one{VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_INFO_KHR, nullptr, pipeline, i};
        uint32_t count = 0;
        check(statistics(gpu.device(), &one, &count, nullptr), "vkGetPipelineExecutableStatisticsKHR");
        std::vector<VkPipelineExecutableStatisticKHR> found(count, {VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_STATISTIC_KHR});
        check(statistics(gpu.device(), &one, &count, found.data()), "vkGetPipelineExecutableStatisticsKHR");
        for (const auto& s : found) {
            const int value = int(s.value.u64);
            if (std::strcmp(s.name, "Inverse Throughput") == 0) out.cycles = value;
            if (std::strcmp(s.name, "Instructions") == 0) out.instructions = value;
            if (std::strcmp(s.name, "Latency") == 0) out.latency = value;
            if (std::strcmp(s.name, "VGPRs") == 0) out.registers = value;
        }
    }
    if (out.cycles == 0) throw Error("Vulkan: " + gpu.name() + " states no inverse throughput");
    return out;
}

}  // namespace

std::vector<CompiledCost> compiledCosts(const Gpu& gpu, std::span<const CostCase> cases) {
    const CostPipelines pipelines(gpu, cases, 0, VK_PIPELINE_CREATE_CAPTURE_STATISTICS_BIT_KHR);
    std::vector<CompiledCost> out;
    for (size_t i = 0; i < cases.size(); ++i) out.push_back(read(gpu, pipelines.pipeline(i)));
    return out;
}

std::vector<double> measuredCosts(const Gpu& gpu, std::span<const CostCase> cases, int points, int rounds) {
    if (gpu.clockTick() <= 0) throw Error("Vulkan: " + gpu.name() + " has no clock for its commands");
    CostPipelines pipelines(gpu, cases, points, 0);
    VkQueryPoolCreateInfo info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
    info.queryType = VK_QUERY_TYPE_TIMESTAMP;
    info.queryCount = 2;
    VkQueryPool pool = VK_NULL_HANDLE;
    check(vkCreateQueryPool(gpu.device(), &info, nullptr, &pool), "vkCreateQueryPool");
    std::vector<double> least(cases.size(), 1e30);
    for (int round = 0; round < rounds; ++round)
        for (size_t i = 0; i < cases.size(); ++i) {
            pipelines.setLight(cases[i].lightClass == LIGHTS_SUN ? 0.00465f : cases[i].lightClass == LIGHTS_SMALL ? 0.0436f : cases[i].lightClass == LIGHTS_MEDIUM ? 0.087f : 0.259f);
            gpu.run([&](VkCommandBuffer commands) {
                vkCmdResetQueryPool(commands, pool, 0, 2);
                vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool, 0);
                pipelines.dispatch(commands, i);
                vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool, 1);
            });
            uint64_t ticks[2]{};
            check(vkGetQueryPoolResults(gpu.device(), pool, 0, 2, sizeof ticks, ticks, sizeof(uint64_t),
                                        VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
                  "vkGetQueryPoolResults");
            least[i] = std::min(least[i], std::max(double(ticks[1] - ticks[0]), 1.0) * gpu.clockTick());
        }
    vkDestroyQueryPool(gpu.device(), pool, nullptr);
    return least;
}

}  // namespace apertura
