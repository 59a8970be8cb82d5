#include <cstdint>
#include <cstring>

#include "runtime/asset/error.h"
#include "runtime/render/renderer.h"

#include "evaluate.comp.h"
#include "evaluate16.comp.h"

namespace apertura {

std::vector<vec2> evaluateOnDevice(const Gpu& gpu, int model, int lightClass, std::span<const Evaluation> inputs, bool half) {
    if (half && !gpu.hasHalf()) throw Error("Vulkan: the device has no 16-bit floats");
    const auto in = upload(gpu, std::as_bytes(inputs), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    const GpuBuffer out(gpu, inputs.size() * sizeof(vec2), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, GpuBuffer::Place::Host);
    const GpuBindings::Binding slots[] = {
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_SHADER_STAGE_COMPUTE_BIT, in.get()},
        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_SHADER_STAGE_COMPUTE_BIT, &out}};
    const GpuBindings bindings(gpu, slots);
    const GpuShader shader = half ? GpuShader(gpu, evaluate16_comp) : GpuShader(gpu, evaluate_comp);
    const int32_t values[] = {model, lightClass};
    const VkSpecializationMapEntry entries[] = {{0, 0, sizeof(int32_t)}, {1, sizeof(int32_t), sizeof(int32_t)}};
    const VkSpecializationInfo constants{2, entries, sizeof values, values};
    VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
    info.stage = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO, nullptr, 0, VK_SHADER_STAGE_COMPUTE_BIT,
                  shader.handle(), "main", &constants};
    info.layout = bindings.layout();
    VkPipeline pipeline = VK_NULL_HANDLE;
    check(vkCreateComputePipelines(gpu.device(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline), "vkCreateComputePipelines");
    gpu.run([&](VkCommandBuffer commands) {
        const VkDescriptorSet set = bindings.set();
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
        vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, bindings.layout(), 0, 1, &set, 0, nullptr);
        vkCmdDispatch(commands, uint32_t((inputs.size() + 63) / 64), 1, 1);
        letHostRead(commands, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
    });
    vkDestroyPipeline(gpu.device(), pipeline, nullptr);
    std::vector<vec2> results(inputs.size());
    std::memcpy(results.data(), out.data(), results.size() * sizeof(vec2));
    return results;
}

}  // namespace apertura
