#include "tools/view/window.h"

#include <SDL.h>
#include <SDL_vulkan.h>
#include <backends/imgui_impl_sdl.h>
#include <backends/imgui_impl_vulkan.h>
#include <imgui.h>

#include <cmath>
#include <cstdlib>
#include <optional>

namespace apertura {
namespace {

[[noreturn]] void fail(const std::string& what) { throw Error(what + ": " + SDL_GetError()); }

// Owns SDL and its window.
struct SdlWindow {
    SDL_Window* window = nullptr;

    SdlWindow(const std::string& title, int width, int height) {
        const auto isSet = [](const char* name) { return std::getenv(name) && *std::getenv(name); };
        if (!isSet("DISPLAY") && !isSet("WAYLAND_DISPLAY"))
            throw Error("no window can be shown: there is no display (neither $DISPLAY nor $WAYLAND_DISPLAY names one)");
        if (SDL_InitSubSystem(SDL_INIT_VIDEO) != 0) fail("no window can be shown");
        // The size that was asked for is in pixels.
        window = SDL_CreateWindow(title.c_str(), SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED, width, height,
                                  SDL_WINDOW_VULKAN | SDL_WINDOW_RESIZABLE);
        if (!window) {
            const std::string cause = SDL_GetError();
            SDL_QuitSubSystem(SDL_INIT_VIDEO);
            throw Error("no window can be shown: " + cause);
        }
    }
    ~SdlWindow() {
        SDL_DestroyWindow(window);
        SDL_QuitSubSystem(SDL_INIT_VIDEO);
    }
    SdlWindow(const SdlWindow&) = delete;

    std::vector<std::string> extensions() const {
        unsigned count = 0;
        if (!SDL_Vulkan_GetInstanceExtensions(window, &count, nullptr)) fail("the window has no Vulkan");
        std::vector<const char*> names(count);
        SDL_Vulkan_GetInstanceExtensions(window, &count, names.data());
        return {names.begin(), names.end()};
    }
};

// ImGui's colours are meant for targets without an sRGB curve.
void makeStyleLinear() {
    for (ImVec4& c : ImGui::GetStyle().Colors)
        for (float* channel : {&c.x, &c.y, &c.z}) *channel = std::pow(*channel, 2.2f);
}

}  // namespace

struct Window::State {
    struct InFlight {
        vk::raii::CommandPool pool;
        vk::raii::CommandBuffer commands;
        vk::raii::Semaphore ready;
        vk::raii::Fence done;
    };

    SdlWindow sdl;
    Gpu gpu;
    Swapchain chain;
    vk::raii::RenderPass widgetsPass = nullptr;  // ImGui's backend draws in one
    vk::raii::DescriptorPool widgetsPool = nullptr;
    std::vector<vk::raii::Framebuffer> framebuffers;
    std::vector<vk::raii::Semaphore> drawn;  // of each image
    std::vector<InFlight> frames;
    int frame = 0;
    bool changed = false;

    State(const std::string& title, int width, int height, bool validate)
        : sdl(title, width, height),
          gpu({.validate = validate,
               .instanceExtensions = sdl.extensions(),
               .makeSurface =
                   [this](VkInstance instance) {
                       VkSurfaceKHR surface = VK_NULL_HANDLE;
                       return SDL_Vulkan_CreateSurface(sdl.window, instance, &surface) ? surface : VK_NULL_HANDLE;
                   }}),
          chain(gpu, wanted()) {
        makeWidgetsPass();
        makeFramebuffers();
        for (int i = 0; i < kFrames; ++i) {
            auto pool = make<vk::raii::CommandPool>(gpu,
                                                    vk::CommandPoolCreateInfo{.flags = vk::CommandPoolCreateFlagBits::eResetCommandBuffer,
                                                                              .queueFamilyIndex = gpu.handles().family});
            auto commands = make<vk::raii::CommandBuffers>(gpu,
                                                           vk::CommandBufferAllocateInfo{.commandPool = *pool, .commandBufferCount = 1});
            frames.push_back({std::move(pool), std::move(commands.front()), make<vk::raii::Semaphore>(gpu, vk::SemaphoreCreateInfo{}),
                              make<vk::raii::Fence>(gpu, vk::FenceCreateInfo{.flags = vk::FenceCreateFlagBits::eSignaled})});
        }
        startWidgets();
    }

    ~State() {
        gpu.waitIdle();
        ImGui_ImplVulkan_Shutdown();
        ImGui_ImplSDL2_Shutdown();
        ImGui::DestroyContext();
    }

    vk::Extent2D wanted() const {
        int width = 0, height = 0;
        SDL_Vulkan_GetDrawableSize(sdl.window, &width, &height);
        return {uint32_t(width), uint32_t(height)};
    }

    void makeWidgetsPass() {
        const vk::AttachmentDescription colour{.format = chain.format(),
                                               .samples = vk::SampleCountFlagBits::e1,
                                               .loadOp = vk::AttachmentLoadOp::eLoad,
                                               .storeOp = vk::AttachmentStoreOp::eStore,
                                               .initialLayout = vk::ImageLayout::eColorAttachmentOptimal,
                                               .finalLayout = vk::ImageLayout::ePresentSrcKHR};
        const vk::AttachmentReference reference{0, vk::ImageLayout::eColorAttachmentOptimal};
        const vk::SubpassDescription subpass{.colorAttachmentCount = 1, .pColorAttachments = &reference};
        constexpr auto output = vk::PipelineStageFlagBits::eColorAttachmentOutput;
        const vk::SubpassDependency after{
            .srcSubpass = VK_SUBPASS_EXTERNAL,
            .srcStageMask = output,
            .dstStageMask = output,
            .srcAccessMask = vk::AccessFlagBits::eColorAttachmentWrite,
            .dstAccessMask = vk::AccessFlagBits::eColorAttachmentRead | vk::AccessFlagBits::eColorAttachmentWrite};
        widgetsPass = make<vk::raii::RenderPass>(gpu, vk::RenderPassCreateInfo{.attachmentCount = 1,
                                                                               .pAttachments = &colour,
                                                                               .subpassCount = 1,
                                                                               .pSubpasses = &subpass,
                                                                               .dependencyCount = 1,
                                                                               .pDependencies = &after});
    }

    void makeFramebuffers() {
        framebuffers.clear();
        drawn.clear();
        for (uint32_t i = 0; i < chain.count(); ++i) {
            const vk::ImageView view = chain.view(i);
            framebuffers.push_back(make<vk::raii::Framebuffer>(gpu, vk::FramebufferCreateInfo{.renderPass = *widgetsPass,
                                                                                              .attachmentCount = 1,
                                                                                              .pAttachments = &view,
                                                                                              .width = chain.size().width,
                                                                                              .height = chain.size().height,
                                                                                              .layers = 1}));
            drawn.push_back(make<vk::raii::Semaphore>(gpu, vk::SemaphoreCreateInfo{}));
        }
    }

    void startWidgets() {
        IMGUI_CHECKVERSION();
        ImGui::CreateContext();
        ImGui::GetIO().IniFilename = nullptr;  // no file that the user did not name
        ImGui::StyleColorsDark();
        makeStyleLinear();
        const vk::DescriptorPoolSize size{vk::DescriptorType::eCombinedImageSampler, 8};
        widgetsPool = make<vk::raii::DescriptorPool>(
            gpu, vk::DescriptorPoolCreateInfo{
                     .flags = vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, .maxSets = 8, .poolSizeCount = 1, .pPoolSizes = &size});
        const GpuHandles& handles = gpu.handles();
        ImGui_ImplSDL2_InitForVulkan(sdl.window);
        ImGui_ImplVulkan_InitInfo info{};
        info.Instance = *handles.instance;
        info.PhysicalDevice = *handles.physical;
        info.Device = *handles.device;
        info.QueueFamily = handles.family;
        info.Queue = *handles.queue;
        info.DescriptorPool = *widgetsPool;
        info.MinImageCount = 2;
        info.ImageCount = std::max(chain.count(), 2u);
        info.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
        info.CheckVkResultFn = [](VkResult result) {
            if (result < 0) throw Error("Vulkan: the widgets: " + vk::to_string(vk::Result(result)));
        };
        ImGui_ImplVulkan_Init(&info, *widgetsPass);
        gpu.run([](VkCommandBuffer commands) { ImGui_ImplVulkan_CreateFontsTexture(commands); });
        ImGui_ImplVulkan_DestroyFontUploadObjects();
    }

    void renew() {
        gpu.waitIdle();
        framebuffers.clear();
        chain.renew(wanted());
        makeFramebuffers();
        changed = false;
    }

    void drawWidgets(vk::CommandBuffer commands, uint32_t image) const {
        commands.beginRenderPass({.renderPass = *widgetsPass, .framebuffer = *framebuffers[image], .renderArea = {{0, 0}, chain.size()}},
                                 vk::SubpassContents::eInline);
        ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), commands);
        commands.endRenderPass();
    }
};

Window::Window(const std::string& title, int width, int height, bool validate)
    : state_(std::make_unique<State>(title, width, height, validate)) {}

Window::~Window() = default;

const Gpu& Window::gpu() const { return state_->gpu; }
vk::Format Window::format() const { return state_->chain.format(); }
vk::Extent2D Window::size() const { return state_->chain.size(); }
int Window::nextFrame() const { return state_->frame; }
void Window::setTitle(const std::string& title) { SDL_SetWindowTitle(state_->sdl.window, title.c_str()); }
void Window::setClipboard(const std::string& text) { SDL_SetClipboardText(text.c_str()); }

bool Window::poll(const std::function<void(const SDL_Event&)>& handle) {
    SDL_Event event;
    while (SDL_PollEvent(&event)) {
        ImGui_ImplSDL2_ProcessEvent(&event);
        const ImGuiIO& io = ImGui::GetIO();
        const bool isKey = event.type == SDL_KEYDOWN || event.type == SDL_KEYUP;
        const bool isMouse = event.type == SDL_MOUSEBUTTONDOWN || event.type == SDL_MOUSEWHEEL;
        if (event.type == SDL_QUIT) return false;
        if (event.type == SDL_WINDOWEVENT && event.window.event == SDL_WINDOWEVENT_CLOSE) return false;
        if (event.type == SDL_WINDOWEVENT && event.window.event == SDL_WINDOWEVENT_SIZE_CHANGED) state_->changed = true;
        if ((isKey && io.WantTextInput) || (isMouse && io.WantCaptureMouse)) continue;
        handle(event);
    }
    return true;
}

void Window::waitFor(int frame) const {
    checked([&] {
        if (state_->gpu.handles().device.waitForFences(*state_->frames[size_t(frame)].done, true, UINT64_MAX) != vk::Result::eSuccess)
            throw Error("Vulkan: a wait ended early");
    });
}

bool Window::frame(const std::function<void()>& widgets, const Draw& draw) {
    State& s = *state_;
    if (s.changed || !s.chain.isVisible()) s.renew();
    if (!s.chain.isVisible()) {
        SDL_Delay(50);
        return false;
    }
    waitFor(s.frame);
    State::InFlight& now = s.frames[size_t(s.frame)];
    const std::optional<uint32_t> image = s.chain.acquire(*now.ready);
    if (!image) {
        s.changed = true;
        return false;
    }
    ImGui_ImplVulkan_NewFrame();
    ImGui_ImplSDL2_NewFrame();
    ImGui::NewFrame();
    widgets();
    ImGui::Render();
    checked([&] {
        s.gpu.handles().device.resetFences(*now.done);
        now.commands.reset();
        now.commands.begin({.flags = vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
        const vk::ImageMemoryBarrier2 fresh{.srcStageMask = vk::PipelineStageFlagBits2::eColorAttachmentOutput,
                                            .dstStageMask = vk::PipelineStageFlagBits2::eColorAttachmentOutput,
                                            .dstAccessMask = vk::AccessFlagBits2::eColorAttachmentWrite,
                                            .oldLayout = vk::ImageLayout::eUndefined,
                                            .newLayout = vk::ImageLayout::eColorAttachmentOptimal,
                                            .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                            .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                            .image = s.chain.image(*image),
                                            .subresourceRange = {vk::ImageAspectFlagBits::eColor, 0, 1, 0, 1}};
        now.commands.pipelineBarrier2({.imageMemoryBarrierCount = 1, .pImageMemoryBarriers = &fresh});
        draw(*now.commands, s.frame, s.chain.view(*image));
        s.drawWidgets(*now.commands, *image);
        now.commands.end();
        const vk::PipelineStageFlags stage = vk::PipelineStageFlagBits::eColorAttachmentOutput;
        const std::lock_guard hold(s.gpu.handles().queueLock);
        s.gpu.handles().queue.submit(vk::SubmitInfo{.waitSemaphoreCount = 1,
                                                    .pWaitSemaphores = &*now.ready,
                                                    .pWaitDstStageMask = &stage,
                                                    .commandBufferCount = 1,
                                                    .pCommandBuffers = &*now.commands,
                                                    .signalSemaphoreCount = 1,
                                                    .pSignalSemaphores = &*s.drawn[*image]},
                                     *now.done);
    });
    s.frame = (s.frame + 1) % kFrames;
    if (!s.chain.present(*image, *s.drawn[*image])) s.changed = true;
    return true;
}

}  // namespace apertura
