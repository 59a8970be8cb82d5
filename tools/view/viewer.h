#pragma once
// What `apertura view` shows and how it is changed. One thread; what takes longer is left to worker.h.
#include <array>
#include <chrono>
#include <deque>
#include <optional>
#include <string>

#include "apertura/runtime/render/stage.h"
#include "tools/view/orbit.h"
#include "tools/view/probe.h"
#include "tools/view/window.h"
#include "tools/view/worker.h"
#include "tools/view_options.h"

namespace apertura {

// What keys and mouse do.
inline constexpr const char* kViewerKeys =
    "left drag: around the target; with shift: across; with ctrl: look\n"
    "right drag: the sun; middle drag: across; wheel: nearer\n"
    "w a s d, q e: fly, with shift faster; home or h: back; c: the file's cameras\n"
    "double click: probe a point; n, b or page keys: next model\n"
    "tab: split; t: truth; x: difference; space or p: a day; arrows: the sun\n"
    "r: light bounces; ctrl+s: save; ctrl+c: copy the render line; F1: panel; escape: end";

// What the user sets.
struct Settings {
    ViewOptions light;                                     // the sun, exposure and tone
    std::array<const Model*, 2> models{nullptr, nullptr};  // of the two pictures; null: the shadow map
    bool split = false, truth = false, heat = false;       // a second picture; it is the reference; it is the difference
    double splitAt = 0.5;
    bool plays = false;  // the sun goes around in a minute
    bool panel = true;
};

class Viewer {
public:
    // `file`, `options`: as the user gave them, for the line that `render` takes; `view`: what they make.
    Viewer(Window& window, const Asset& asset, const std::string& file, const ViewOptions& options, const View& view);
    ~Viewer();

    void handle(const SDL_Event& event);
    // Draws one frame. `scripted`: time goes by a fixed step, so that pictures do not depend on the machine.
    void frame(bool scripted);
    // True once what is wanted is drawn at its best, and nothing is under way; truth need not have converged.
    bool isSettled() const { return settledFrames_ > 2; }
    bool isDone() const { return done_; }

    // Writes what is shown, without the panel, as `render` would: .png or .exr. Where the difference is shown, the second picture itself.
    // Throws Error.
    void save(const std::string& path);
    std::string renderLine() const;

    Window& window() { return window_; }
    void moveLamps(double metres);  // all that stand in the scene, upwards
    // The names that a script and the panel know models by; "shadow-map" is one, and for the second picture "reference". Throws Error where
    // there is none.
    void setModel(int picture, const std::string& name);
    std::vector<std::string> modelNames() const;

    Settings settings;
    Orbit orbit;
    std::optional<TruthTracer::State> truth;

private:
    struct Times {
        double draw = 0, compose = 0;  // seconds on the device
    };

    View currentView() const;
    Wanted wantedFor(const Model* model, const View& view) const;
    void key(int symbol, int modifiers);
    void advance(double seconds);
    void readTimes(int frame);
    void panel();
    void panelLights();
    void panelModels();
    void panelTruth();
    void panelCost();
    void message(const std::string& text);
    void clicked(double x, double y);

    Window& window_;
    const Asset& asset_;
    std::string file_;
    Renderer renderer_;
    RendererLock rendererLock_;
    std::optional<Stage> stage_;
    std::optional<Preparer> preparer_;
    std::optional<TruthTracer> tracer_;
    std::optional<ProbeResult> probed_;
    vk::raii::QueryPool clock_;
    View base_;                                   // lights beside the sun, the sky
    std::array<std::optional<Wanted>, 2> shown_;  // what the pictures were last drawn with
    View drawnView_;
    int drawnSamples_ = 1, drawnFrame_ = 0;
    int settledFrames_ = 0;
    size_t camera_ = 0;
    bool done_ = false, draggingSplit_ = false, dragging_ = false, lampsMoved_ = false;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now(), changed_ = last_;
    std::deque<Times> times_;
    std::array<bool, Window::kFrames> timed_{}, drewIn_{};  // of each frame
    // Counts changes of what is drawn, and which of them each frame has drawn.
    uint64_t change_ = 1;
    std::tuple<std::array<std::optional<Wanted>, 2>, bool, int> content_;
    std::array<uint64_t, Window::kFrames> has_{};
    std::string message_;
    std::chrono::steady_clock::time_point messageUntil_{};
    size_t saved_ = 0;
};

}  // namespace apertura
