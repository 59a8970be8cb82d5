#include "tools/view/worker.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "apertura/bake/measure/reference.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/render/draw.h"

namespace apertura {
namespace {

constexpr int kMostPasses = 256;

bool isSame(const AperturaLight& a, const AperturaLight& b) {
    return a.cap.axis == b.cap.axis && a.cap.sinRadius == b.cap.sinRadius && a.sphere == b.sphere && a.radiance == b.radiance;
}

// Whether two views give the same picture.
bool isSame(const View& a, const View& b) {
    return a.camera.eye == b.camera.eye && a.camera.target == b.camera.target && a.camera.up == b.camera.up
        && a.camera.verticalFov == b.camera.verticalFov && a.width == b.width && a.height == b.height && a.albedo == b.albedo
        && a.plain == b.plain && a.bounces == b.bounces && a.sky.picture() == b.sky.picture()
        && a.sky.bands().bands[0] == b.sky.bands().bands[0]
        && std::equal(a.lights.begin(), a.lights.end(), b.lights.begin(), b.lights.end(),
                      [](const AperturaLight& x, const AperturaLight& y) { return isSame(x, y); });
}

Picture enlarged(const Picture& from, int width, int height) {
    Picture out{width, height, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            out.pixels.push_back(from.pixels[size_t(std::min(y * from.height / height, from.height - 1)) * size_t(from.width)
                                             + size_t(std::min(x * from.width / width, from.width - 1))]);
    return out;
}

double meanOf(const Picture& p) {
    double sum = 0;
    for (const glm::vec3& pixel : p.pixels) sum += double(pixel.r + pixel.g + pixel.b) / 3;
    return sum / double(std::max<size_t>(p.pixels.size(), 1));
}

}  // namespace

double relativeDifference(const Picture& a, const Picture& b) {
    // Lights that are seen are many times as bright as all else, and the same in both.
    constexpr float kMost = 16;
    double sum = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i) {
        const glm::dvec3 off = glm::min(a.pixels[i], kMost) - glm::min(b.pixels[i], kMost);
        sum += glm::dot(off, off) / 3;
    }
    Picture capped = b;
    for (glm::vec3& p : capped.pixels) p = glm::min(p, kMost);
    return std::sqrt(sum / double(std::max<size_t>(a.pixels.size(), 1))) / std::max(meanOf(capped), 1e-9);
}

Preparer::Preparer(const Gpu& gpu, Renderer& renderer, RendererLock& lock, VkFormat format, int spare)
    : gpu_(gpu), renderer_(renderer), rendererLock_(lock), format_(format), spare_(spare), thread_([this] { work(); }) {}

Preparer::~Preparer() {
    {
        const std::lock_guard hold(lock_);
        stop_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

bool Preparer::isReady(const Wanted& wanted, const View& view) {
    const std::lock_guard hold(lock_);
    if (ready_.contains(wanted)) return true;
    const bool isQueued = std::any_of(queue_.begin(), queue_.end(), [&](const auto& entry) { return entry.first == wanted; });
    if (!failed_.contains(wanted) && !isQueued) {
        queue_.emplace_front(wanted, view);
        changed_.notify_all();
    }
    return false;
}

void Preparer::prepare(const Wanted& wanted, View view) {
    const std::lock_guard adding(rendererLock_);
    const Offscreen small(gpu_, {16, 16}, vk::Format(format_));
    if (wanted.model)
        renderer_.prepare(*wanted.model, wanted.lightClass, format_, wanted.at, wanted.lights == 1 ? 1 : APERTURA_MAX_LIGHTS,
                          wanted.bounces);
    else
        renderer_.prepareShadowMapped(format_);
    gpu_.run([&](VkCommandBuffer commands) {
        small.begin(commands);
        if (wanted.model)
            renderer_.record(commands, small.target(), view, *wanted.model, spare_, wanted.at);
        else if (view.lights.size() == 1 && !aperturaIsSphere(view.lights[0]))
            renderer_.recordShadowMapped(commands, small.target(), view, spare_);
        small.end(commands);
    });
}

bool Preparer::isBusy() const {
    const std::lock_guard hold(lock_);
    return busy_ || !queue_.empty();
}

std::optional<std::string> Preparer::takeError() {
    const std::lock_guard hold(lock_);
    return std::exchange(error_, std::nullopt);
}

void Preparer::work() {
    std::unique_lock hold(lock_);
    while (!stop_) {
        if (queue_.empty()) {
            changed_.wait(hold);
            continue;
        }
        const auto [wanted, view] = queue_.front();
        busy_ = true;
        hold.unlock();
        std::optional<std::string> error;
        try {
            prepare(wanted, view);
        } catch (const std::exception& e) {
            error = e.what();
        }
        hold.lock();
        busy_ = false;
        std::erase_if(queue_, [&, done = wanted](const auto& entry) { return entry.first == done; });
        (error ? failed_ : ready_).insert(wanted);
        if (error) error_ = error;
    }
}

TruthTracer::TruthTracer(const Scene& scene, Renderer& renderer, RendererLock& lock)
    : scene_(scene), renderer_(renderer), rendererLock_(lock), thread_([this] { work(); }) {}

TruthTracer::~TruthTracer() {
    {
        const std::lock_guard hold(lock_);
        stop_ = true;
        ++number_;
    }
    changed_.notify_all();
    thread_.join();
}

bool TruthTracer::want(const View& view, const Model* model, LightAt at) {
    const std::lock_guard hold(lock_);
    if (request_ && isSame(request_->view, view) && request_->model == model && request_->at == at) return false;
    request_ = {view, model, at};
    fresh_.reset();
    ++number_;
    changed_.notify_all();
    return true;
}

void TruthTracer::pause() {
    const std::lock_guard hold(lock_);
    if (!request_) return;
    request_.reset();
    fresh_.reset();
    ++number_;
}

std::optional<TruthTracer::State> TruthTracer::take() {
    const std::lock_guard hold(lock_);
    return std::exchange(fresh_, std::nullopt);
}

std::optional<std::string> TruthTracer::takeError() {
    const std::lock_guard hold(lock_);
    return std::exchange(error_, std::nullopt);
}

bool TruthTracer::isCurrent(uint64_t number) const {
    const std::lock_guard hold(lock_);
    return number == number_;
}

void TruthTracer::publish(State state, uint64_t number) {
    const std::lock_guard hold(lock_);
    if (number == number_) fresh_ = std::move(state);
}

void TruthTracer::refine(const Tracer& tracer, const Request& request, uint64_t number) {
    const Progress goOn = [&](double) { return isCurrent(number); };
    View coarse = request.view;
    coarse.width = std::max(coarse.width / 4, 1), coarse.height = std::max(coarse.height / 4, 1);
    const Picture preview = traceReference(tracer, coarse, {.lightRays = 4, .skyRays = 16, .paths = 4}, goOn);
    publish({enlarged(preview, request.view.width, request.view.height)}, number);
    Picture drawn;
    {
        const std::lock_guard adding(rendererLock_);
        if (isCurrent(number) && !request.model)
            drawn = renderer_.drawShadowMapped(request.view);
        else if (isCurrent(number))
            drawn = renderer_.draw(request.view, *request.model, request.at);
    }
    Picture sum{request.view.width, request.view.height, std::vector<glm::vec3>(size_t(request.view.width) * size_t(request.view.height))};
    double squares = 0;  // of the passes' differences from their mean, summed over pixels and channels (Welford)
    State state;
    for (int pass = 0; pass < kMostPasses && !state.isConverged; ++pass) {
        const ReferenceOptions options{.lightRays = 4, .skyRays = 16, .paths = 4, .seed = uint32_t(pass + 1)};
        const Picture next = traceReference(tracer, request.view, options, goOn);
        for (size_t i = 0; i < sum.pixels.size(); ++i) {
            const glm::dvec3 before = sum.pixels[i], now = before + (glm::dvec3(next.pixels[i]) - before) / double(pass + 1);
            const glm::dvec3 a = glm::dvec3(next.pixels[i]) - before, b = glm::dvec3(next.pixels[i]) - now;
            squares += (a.x * b.x + a.y * b.y + a.z * b.z) / 3;
            sum.pixels[i] = now;
        }
        state.picture = sum;
        state.passes = pass + 1;
        if (pass > 0) state.noise = std::sqrt(squares / double(sum.pixels.size()) / pass / (pass + 1)) / std::max(meanOf(sum), 1e-9);
        if (!drawn.pixels.empty()) state.difference = relativeDifference(drawn, sum);
        state.isConverged = pass > 0 && (state.noise < 0.1 * state.difference || state.noise < 0.002);
        publish(state, number);
    }
}

void TruthTracer::work() {
    std::optional<Tracer> tracer;
    try {
        tracer.emplace(scene_);
        tracer_ = &*tracer;
    } catch (const std::exception& e) {
        const std::lock_guard hold(lock_);
        error_ = e.what();
    }
    std::unique_lock hold(lock_);
    uint64_t done = 0;
    while (!stop_) {
        if (!request_ || done == number_) {
            changed_.wait(hold);
            continue;
        }
        const Request request = *request_;
        const uint64_t number = done = number_;
        hold.unlock();
        std::optional<std::string> error;
        try {
            if (tracer) refine(*tracer, request, number);
        } catch (const Cancelled&) {
        } catch (const std::exception& e) {
            error = e.what();
        }
        hold.lock();
        if (error) error_ = error;
    }
    tracer_ = nullptr;
}

}  // namespace apertura
