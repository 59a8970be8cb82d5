#pragma once
// A window with a Vulkan swapchain and Dear ImGui over it: SDL2.
#include <functional>
#include <memory>
#include <string>

#include "apertura/runtime/render/resources.h"
#include "apertura/runtime/render/swapchain.h"

union SDL_Event;

namespace apertura {

class Window {
public:
    static constexpr int kFrames = 2;  // in flight

    // Throws Error where there is no display or no device that shows images.
    Window(const std::string& title, int width, int height, bool validate);
    ~Window();
    Window(const Window&) = delete;

    const Gpu& gpu() const;
    vk::Format format() const;
    vk::Extent2D size() const;  // pixels

    // Calls `handle` for each event that has come and that no widget takes. False once the window was closed.
    bool poll(const std::function<void(const SDL_Event&)>& handle);

    // Draws a frame: `widgets` makes those of ImGui, `draw` records to an image in COLOR_ATTACHMENT_OPTIMAL. False where nothing was shown:
    // the window has no area, or another size than before.
    using Draw = std::function<void(vk::CommandBuffer, int frame, vk::ImageView to)>;
    bool frame(const std::function<void()>& widgets, const Draw& draw);
    void waitFor(int frame) const;  // until the device has finished it
    int nextFrame() const;

    void setTitle(const std::string& title);
    void setClipboard(const std::string& text);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace apertura
