#include <cstdint>
#include <cstring>

#include "apertura/runtime/render/renderer.h"
#include "apertura/runtime/render/resources.h"

#include "evaluate.comp.h"
#include "evaluate16.comp.h"

namespace apertura {

std::vector<vec2> evaluateOnDevice(const Gpu& gpu, int model, int lightClass, std::span<const AperturaEvaluation> inputs, bool half) {
    if (half && !gpu.hasHalf()) throw Error("Vulkan: the device has no 16-bit floats");
    constexpr auto storage = vk::BufferUsageFlagBits::eStorageBuffer;
    const GpuBuffer in = upload(gpu, std::as_bytes(inputs), storage);
    const GpuBuffer out(gpu, inputs.size() * sizeof(vec2), storage, GpuBuffer::Place::Host);
    const GpuBindings::Binding slots[] = {{vk::DescriptorType::eStorageBuffer, vk::ShaderStageFlagBits::eCompute, &in},
                                          {vk::DescriptorType::eStorageBuffer, vk::ShaderStageFlagBits::eCompute, &out}};
    const GpuBindings bindings(gpu, slots);
    const int32_t constants[] = {model, lightClass};
    const std::span<const uint32_t> words = half ? std::span<const uint32_t>(evaluate16_comp) : evaluate_comp;
    const vk::raii::Pipeline pipeline = makeComputePipeline(gpu, words, constants, bindings);
    gpu.run([&](vk::CommandBuffer commands) {
        commands.bindPipeline(vk::PipelineBindPoint::eCompute, *pipeline);
        bindings.bind(commands, vk::PipelineBindPoint::eCompute);
        commands.dispatch(uint32_t((inputs.size() + 63) / 64), 1, 1);
        letHostRead(commands, vk::PipelineStageFlagBits2::eComputeShader, vk::AccessFlagBits2::eShaderStorageWrite);
    });
    std::vector<vec2> results(inputs.size());
    std::memcpy(results.data(), out.data(), results.size() * sizeof(vec2));
    return results;
}

}  // namespace apertura
