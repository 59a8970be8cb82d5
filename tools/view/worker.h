#pragma once
// What takes longer than a frame, on threads of its own: making a model ready to be drawn, and tracing truth.
#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <tuple>

#include "apertura/bake/sampling/tracer.h"
#include "apertura/runtime/asset/picture.h"
#include "apertura/runtime/render/renderer.h"

namespace apertura {

// Held by the thread that adds to a Renderer: see its head.
using RendererLock = std::mutex;

// A model, or a shadow map in place of null, as a frame needs it.
struct Wanted {
    const Model* model;
    int lightClass = APERTURA_LIGHTS_SUN;
    LightAt at = LightAt::Pixels;
    int lights = 1;  // 1, or any number
    int bounces = APERTURA_BOUNCES_NONE;
    bool operator==(const Wanted&) const = default;
    bool operator<(const Wanted& other) const {
        return std::tie(model, lightClass, at, lights, bounces)
             < std::tie(other.model, other.lightClass, other.at, other.lights, other.bounces);
    }
};

// Prepares models, one after another, the last that was asked for first. Each is drawn once, small and unseen: drivers compile the last
// part of a pipeline when it is first used.
class Preparer {
public:
    // `spare`: a frame of the renderer's that nobody else records without the lock.
    Preparer(const Gpu& gpu, Renderer& renderer, RendererLock& lock, VkFormat format, int spare);
    ~Preparer();

    // Whether it is ready; if not, it will be. `view`: one that is drawn so.
    bool isReady(const Wanted& wanted, const View& view);
    bool isBusy() const;
    // Why a model could not be prepared, once.
    std::optional<std::string> takeError();

private:
    void work();
    void prepare(const Wanted& wanted, View view);

    const Gpu& gpu_;
    Renderer& renderer_;
    RendererLock& rendererLock_;
    VkFormat format_;
    int spare_;
    mutable std::mutex lock_;
    std::condition_variable changed_;
    std::deque<std::pair<Wanted, View>> queue_;
    std::set<Wanted> ready_, failed_;
    std::optional<std::string> error_;
    bool stop_ = false, busy_ = false;
    std::thread thread_;
};

// The reference of a view, refined for as long as the view stays.
class TruthTracer {
public:
    struct State {
        Picture picture;           // of the view's size
        int passes = 0;            // 0: a coarse preview
        double noise = 0;          // RMS of the picture's own error, of its mean radiance; from two passes on
        double difference = -1;    // RMS of the drawn picture less this one, of its mean radiance; < 0: not known yet
        bool isConverged = false;  // its noise is a tenth of the difference, or below 0.002
    };

    // `scene` must outlive it. The acceleration structure is built on its own thread, at once.
    TruthTracer(const Scene& scene, Renderer& renderer, RendererLock& lock);
    ~TruthTracer();

    // Traces this view from now on; false: it already does. `model`: what it is compared with, null: a shadow map.
    bool want(const View& view, const Model* model, LightAt at);
    void pause();
    const Tracer* tracer() const { return tracer_; }  // null until it is built
    // What there is, if it is newer than what was taken before.
    std::optional<State> take();
    std::optional<std::string> takeError();

private:
    struct Request {
        View view;
        const Model* model;
        LightAt at;
    };
    void work();
    void refine(const Tracer& tracer, const Request& request, uint64_t number);
    bool isCurrent(uint64_t number) const;
    void publish(State state, uint64_t number);

    const Scene& scene_;
    Renderer& renderer_;
    RendererLock& rendererLock_;
    mutable std::mutex lock_;
    std::condition_variable changed_;
    std::optional<Request> request_;
    uint64_t number_ = 0;  // of requests
    std::optional<State> fresh_;
    std::optional<std::string> error_;
    bool stop_ = false;
    std::atomic<const Tracer*> tracer_ = nullptr;
    std::thread thread_;
};

// RMS of a - b over the pixels' channels, of the mean of b.
double relativeDifference(const Picture& a, const Picture& b);

}  // namespace apertura
