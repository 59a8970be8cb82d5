#include "tools/view/viewer.h"

#include <SDL.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>

#include "apertura/runtime/asset/error.h"

namespace apertura {
namespace {

constexpr double kStep = 1.0 / 30;                      // seconds, between frames of a script
constexpr double kDay = 60;                             // seconds that a day takes
constexpr auto kRest = std::chrono::milliseconds(250);  // after which a still picture is drawn with all samples
constexpr size_t kTimes = 120;

double sizeOf(const Scene& scene) {
    const Box box = worldBounds(scene);
    return glm::length(glm::dvec3(box.high) - glm::dvec3(box.low));
}

// For a shell.
std::string quoted(const std::string& text) {
    const bool plain = text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./:+-#") == std::string::npos;
    if (plain && !text.empty()) return text;
    std::string out = "'";
    for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

bool isSame(const Camera& a, const Camera& b) {
    return a.eye == b.eye && a.target == b.target && a.up == b.up && a.verticalFov == b.verticalFov;
}

}  // namespace

Viewer::Viewer(Window& window, const Asset& asset, const std::string& file, const ViewOptions& options, const View& view)
    : orbit(viewOf(asset.scene), sizeOf(asset.scene)),
      window_(window),
      asset_(asset),
      file_(file),
      renderer_(window.gpu(), asset, 2 * Window::kFrames),
      clock_(make<vk::raii::QueryPool>(
          window.gpu(), vk::QueryPoolCreateInfo{.queryType = vk::QueryType::eTimestamp, .queryCount = 3 * Window::kFrames})) {
    settings.light = options;
    base_ = view;
    if (!options.noSun) base_.lights.erase(base_.lights.begin());
    orbit.set(base_.camera);
    const Model* const stored = storedModel(asset.info);
    settings.models = {stored ? stored : findModel("soft"), nullptr};
    renderer_.prepareSky(base_.sky);
    preparer_.emplace(window.gpu(), renderer_, rendererLock_, Stage::kFormat, 2 * Window::kFrames);
    tracer_.emplace(asset.scene, renderer_, rendererLock_);
}

Viewer::~Viewer() {
    tracer_.reset();
    preparer_.reset();
    window_.gpu().waitIdle();
}

View Viewer::currentView() const {
    View view = base_;
    view.camera = orbit.camera();
    view.width = int(window_.size().width), view.height = int(window_.size().height);
    view.plain = settings.light.plain || !settings.light.albedo.empty();
    view.bounces = settings.light.bounces;
    if (!settings.light.noSun)
        view.lights.insert(view.lights.begin(), sunLight(settings.light.azimuth, settings.light.elevation, settings.light.radius));
    return view;
}

Wanted Viewer::wantedFor(const Model* model, const View& view) const {
    if (!model) return {};
    const double pixels = double(view.width) * view.height * 4;
    return {model, lightClassOf(view), renderer_.betterLightAt(*model, pixels), view.lights.size() == 1 ? 1 : 2, renderer_.bouncesOf(view)};
}

void Viewer::message(const std::string& text) {
    message_ = text;
    messageUntil_ = std::chrono::steady_clock::now() + std::chrono::seconds(6);
}

std::vector<std::string> Viewer::modelNames() const {
    std::vector<std::string> out;
    const Model* const stored = storedModel(asset_.info);
    for (const Model& model : models())
        if (model.fromVisibility || &model == stored) out.emplace_back(model.name);
    out.emplace_back("shadow-map");
    return out;
}

void Viewer::moveLamps(double metres) {
    for (AperturaLight& light : base_.lights)
        if (aperturaIsSphere(light)) light.sphere.y += float(metres), lampsMoved_ = true;
}

void Viewer::setModel(int picture, const std::string& name) {
    if (picture == 1) settings.split = true, settings.truth = name == "reference";
    if (picture == 1 && settings.truth) return;
    const std::vector<std::string> names = modelNames();
    if (std::find(names.begin(), names.end(), name) == names.end()) throw Error(asset_.scene.name + ": does not hold the model " + name);
    settings.models[size_t(picture)] = findModel(name);
}

void Viewer::advance(double seconds) {
    if (settings.plays) settings.light.azimuth = std::fmod(settings.light.azimuth + 360 * seconds / kDay, 360);
    if (settings.plays)  // up in the east, down in the west, and through the night at once
        settings.light.elevation = 60 * std::max(std::sin((settings.light.azimuth - 90) * std::numbers::pi / 180), 0.02);
    const Uint8* const keys = SDL_GetKeyboardState(nullptr);
    if (ImGui::GetIO().WantTextInput || (SDL_GetModState() & KMOD_CTRL)) return;
    const auto held = [&](SDL_Scancode a, SDL_Scancode b) { return double(keys[a]) - double(keys[b]); };
    const double right = held(SDL_SCANCODE_D, SDL_SCANCODE_A), up = held(SDL_SCANCODE_E, SDL_SCANCODE_Q),
                 forward = held(SDL_SCANCODE_W, SDL_SCANCODE_S), fast = SDL_GetModState() & KMOD_SHIFT ? 4 : 1;
    if (right != 0 || up != 0 || forward != 0) {
        const double step = 0.15 * fast * seconds;
        orbit.fly(step * right, step * up, step * forward);
    }
}

void Viewer::key(int symbol, int modifiers) {
    const auto next = [&](int step) {
        const std::vector<std::string> names = modelNames();
        const std::string now = settings.models[0] ? std::string(settings.models[0]->name) : "shadow-map";
        const auto at = int(std::find(names.begin(), names.end(), now) - names.begin()), count = int(names.size());
        setModel(0, names[size_t((at + step + count) % count)]);
    };
    if (modifiers & KMOD_CTRL) {
        if (symbol == SDLK_c) window_.setClipboard(renderLine()), message("copied: " + renderLine());
        if (symbol == SDLK_s) {
            std::string path;
            do path = "apertura-" + std::to_string(++saved_) + ".png";
            while (std::filesystem::exists(path));
            try {
                save(path);
                message("saved " + path);
            } catch (const Error& e) {
                message(e.what());
            }
        }
        return;
    }
    switch (symbol) {
        case SDLK_ESCAPE: done_ = true; break;
        case SDLK_HOME:
        case SDLK_h: orbit.goHome(); break;
        case SDLK_c:
            if (!asset_.scene.cameras.empty()) orbit.set(asset_.scene.cameras[camera_++ % asset_.scene.cameras.size()]);
            break;
        case SDLK_PAGEDOWN:
        case SDLK_n: next(1); break;
        case SDLK_PAGEUP:
        case SDLK_b: next(-1); break;
        case SDLK_TAB: settings.split = !settings.split; break;
        case SDLK_t:
            settings.truth = !settings.truth;
            settings.split = settings.truth;
            break;
        case SDLK_x:
            settings.heat = !settings.heat;
            settings.split = settings.split || settings.heat;
            break;
        case SDLK_SPACE:
        case SDLK_p: settings.plays = !settings.plays; break;
        case SDLK_r: settings.light.bounces = settings.light.bounces > 0 ? 0 : kBounces; break;
        case SDLK_F1: settings.panel = !settings.panel; break;
        case SDLK_LEFT: settings.light.azimuth = std::fmod(settings.light.azimuth + 355, 360); break;
        case SDLK_RIGHT: settings.light.azimuth = std::fmod(settings.light.azimuth + 5, 360); break;
        case SDLK_UP: settings.light.elevation = std::min(settings.light.elevation + 2, 90.0); break;
        case SDLK_DOWN: settings.light.elevation = std::max(settings.light.elevation - 2, -90.0); break;
        default: break;
    }
}

void Viewer::clicked(double x, double y) {
    const Tracer* const tracer = tracer_->tracer();
    if (!tracer) return message("the scene is being made ready for rays");
    const View view = currentView();
    const glm::vec3 ray = rayThrough(view.camera, double(view.width) / view.height, x / view.width, y / view.height);
    const Model* const model = settings.models[0] ? settings.models[0] : findModel("soft");
    probed_ = Probe(asset_, *tracer).at(view, ray, *model);
    if (!probed_) message("nothing of the scene is there");
}

void Viewer::handle(const SDL_Event& event) {
    const double height = window_.size().height, width = window_.size().width;
    switch (event.type) {
        case SDL_KEYDOWN: key(event.key.keysym.sym, event.key.keysym.mod); break;
        case SDL_MOUSEWHEEL: orbit.zoom(double(event.wheel.preciseY)); break;
        case SDL_MOUSEBUTTONDOWN: {
            const bool onHandle = settings.split && std::abs(event.button.x - settings.splitAt * width) < 8;
            // A drag that begins on a widget is the widget's: it does not come here.
            dragging_ = true;
            if (event.button.button == SDL_BUTTON_LEFT && onHandle) draggingSplit_ = true;
            if (event.button.button == SDL_BUTTON_LEFT && (event.button.clicks == 2 || (SDL_GetModState() & KMOD_ALT)))
                clicked(event.button.x, event.button.y);
            break;
        }
        case SDL_MOUSEBUTTONUP: draggingSplit_ = dragging_ = false; break;
        case SDL_MOUSEMOTION: {
            if (!dragging_) break;
            const double right = event.motion.xrel / height, down = event.motion.yrel / height;
            const Uint32 buttons = event.motion.state;
            if (draggingSplit_)
                settings.splitAt = std::clamp(event.motion.x / width, 0.0, 1.0);
            else if (buttons & SDL_BUTTON_RMASK) {
                settings.light.azimuth = std::fmod(settings.light.azimuth + 180 * right + 720, 360.0);
                settings.light.elevation = std::clamp(settings.light.elevation - 90 * down, -90.0, 90.0);
            } else if (buttons & SDL_BUTTON_MMASK || (buttons & SDL_BUTTON_LMASK && (SDL_GetModState() & KMOD_SHIFT)))
                orbit.pan(right, down);
            else if (buttons & SDL_BUTTON_LMASK && (SDL_GetModState() & KMOD_CTRL))
                orbit.look(-right, -down);
            else if (buttons & SDL_BUTTON_LMASK)
                orbit.turn(right, down);
            break;
        }
        default: break;
    }
}

void Viewer::readTimes(int frame) {
    if (window_.gpu().clockTick() <= 0 || !timed_[size_t(frame)]) return;
    timed_[size_t(frame)] = false;
    const auto [result, ticks] = clock_.getResults<uint64_t>(3 * uint32_t(frame), 3, 3 * sizeof(uint64_t), sizeof(uint64_t),
                                                             vk::QueryResultFlagBits::e64);
    if (result != vk::Result::eSuccess) return;
    const auto seconds = [&](size_t i) { return double(ticks[i + 1] - ticks[i]) * window_.gpu().clockTick(); };
    // A picture that rests is not drawn again.
    if (drewIn_[size_t(frame)]) times_.push_back({seconds(0), seconds(1)});
    if (times_.size() > kTimes) times_.pop_front();
}

void Viewer::frame(bool scripted) {
    const auto now = std::chrono::steady_clock::now();
    advance(scripted ? kStep : std::min(std::chrono::duration<double>(now - last_).count(), 0.1));
    last_ = now;
    if (!stage_ || stage_->size() != window_.size()) {
        window_.gpu().waitIdle();
        stage_.reset();
        if (window_.size().width > 0 && window_.size().height > 0)
            stage_.emplace(window_.gpu(), window_.size(), window_.format(), Window::kFrames);
        truth.reset();
        tracer_->pause();
        ++change_;
    }
    const View view = currentView();
    const bool moved = !isSame(view.camera, drawnView_.camera) || view.lights.size() != drawnView_.lights.size()
                    || view.plain != drawnView_.plain || view.bounces != drawnView_.bounces
                    || !std::equal(view.lights.begin(), view.lights.end(), drawnView_.lights.begin(), [](const auto& a, const auto& b) {
                           return a.cap.axis == b.cap.axis && a.cap.sinRadius == b.cap.sinRadius && a.sphere == b.sphere;
                       });
    if (moved) changed_ = now;
    const bool rests = now - changed_ > kRest;
    // A shadow map is drawn of one light from a direction, and of no others.
    const bool mapped = view.lights.size() == 1 && !aperturaIsSphere(view.lights[0]);
    for (size_t i = 0; i < 2; ++i)
        if (!settings.models[i] && !mapped && (i == 0 || (settings.split && !settings.truth))) {
            settings.models[i] = findModel("soft");
            const std::string why = "a shadow map is drawn of one light from a direction alone: soft is shown";
            if (scripted) throw Error(why);
            message(why);
        }
    // What was drawn last stays until what is wanted is ready.
    bool waiting = false;
    for (size_t i = 0; i < 2; ++i) {
        const Wanted wanted = wantedFor(settings.models[i], view);
        if (i == 1 && (!settings.split || settings.truth)) continue;
        if (preparer_->isReady(wanted, view))
            shown_[i] = wanted;
        else
            waiting = true;
        // The model before, if it takes these lights.
        if (shown_[i] && ((!shown_[i]->model && !mapped) || !preparer_->isReady(wantedFor(shown_[i]->model, view), view)))
            shown_[i].reset();
        if (shown_[i]) shown_[i] = wantedFor(shown_[i]->model, view);
    }
    for (const auto& error : {preparer_->takeError(), tracer_->takeError()}) {
        if (error && scripted) throw Error(*error);
        if (error) message(*error);
    }
    if (settings.truth && rests && shown_[0]) {
        if (tracer_->want(view, shown_[0]->model, shown_[0]->at)) truth.reset();
    } else if (moved || !settings.truth) {
        tracer_->pause();
    }
    if (moved) truth.reset();
    if (auto fresh = tracer_->take(); fresh && stage_) {
        truth = std::move(fresh);
        stage_->setTruth(truth->picture);
    }
    Composition composition;
    composition.split = settings.split && (settings.truth ? truth.has_value() : shown_[1].has_value()) ? settings.splitAt : 1;
    composition.exposure = settings.light.exposure;
    composition.toned = settings.light.tone == "neutral";
    composition.heat = settings.heat;
    composition.isTruth = settings.truth;
    composition.samples = rests ? 2 : 1;
    const std::tuple<std::array<std::optional<Wanted>, 2>, bool, int> content(shown_, composition.split < 1 && !settings.truth,
                                                                              composition.samples);
    if (moved || content != content_) ++change_;
    content_ = content;
    const int frame = window_.nextFrame();
    composition.redraw = has_[size_t(frame)] != change_;
    const bool drawn = window_.frame(
        [&] {
            readTimes(frame);
            panel();
        },
        [&](vk::CommandBuffer commands, int number, vk::ImageView to) {
            if (!stage_ || stage_->size() != window_.size()) return;
            const vk::raii::QueryPool* const clock = window_.gpu().clockTick() > 0 ? &clock_ : nullptr;
            stage_->record(
                commands, number, composition, to,
                [&](int picture, const RenderTarget& target) {
                    const std::optional<Wanted>& model = shown_[size_t(picture)];
                    const int slot = 2 * number + picture;
                    if (!model) return;
                    if (model->model)
                        renderer_.record(commands, target, view, *model->model, slot, model->at);
                    else
                        renderer_.recordShadowMapped(commands, target, view, slot);
                },
                clock);
            timed_[size_t(number)] = clock;
            drewIn_[size_t(number)] = composition.redraw;
        });
    if (!drawn) return;
    has_[size_t(frame)] = change_;
    drawnView_ = view;
    drawnSamples_ = composition.samples;
    drawnFrame_ = frame;
    const bool settled = rests && !waiting && !moved && shown_[0] && (!settings.truth || truth);
    settledFrames_ = settled ? settledFrames_ + 1 : 0;
}

void Viewer::save(const std::string& path) {
    if (!stage_ || !shown_[0]) throw Error(path + ": nothing is drawn yet");
    const Picture first = stage_->read(drawnFrame_, 0, drawnSamples_);
    Picture out = first;
    if (settings.split && settings.splitAt < 1) {
        const bool hasTruth = settings.truth && truth;
        const Picture second = hasTruth ? truth->picture : stage_->read(drawnFrame_, 1, drawnSamples_);
        const int from = int(std::round(settings.splitAt * out.width));
        for (int y = 0; y < out.height; ++y)
            for (int x = from; x < out.width; ++x)
                out.pixels[size_t(y) * size_t(out.width) + size_t(x)] = second.pixels[size_t(y) * size_t(out.width) + size_t(x)];
    }
    const bool linear = path.ends_with(".exr");
    writePicture(path, linear ? out : shown(std::move(out), settings.light.exposure, settings.light.tone == "neutral"));
}

std::string Viewer::renderLine() const {
    const Camera camera = orbit.camera();
    const ViewOptions& o = settings.light;
    std::string out = "apertura render " + quoted(file_) + " -o picture.png --model "
                    + (settings.models[0] ? std::string(settings.models[0]->name) : "shadow-map");
    if (!isSame(camera, viewOf(asset_.scene))) {
        char text[256];
        std::snprintf(text, sizeof text, " --camera=%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g", double(camera.eye.x), double(camera.eye.y),
                      double(camera.eye.z), double(camera.target.x), double(camera.target.y), double(camera.target.z),
                      double(camera.verticalFov) * 180 / std::numbers::pi);
        out += text;
    }
    const auto add = [&](const char* form, double value) {
        char part[64];
        std::snprintf(part, sizeof part, form, value);
        out += part;
    };
    if (o.noSun) {
        out += " --no-sun";
    } else {
        add(" --sun-azimuth %.9g", o.azimuth);
        add(" --sun-elevation %.9g", o.elevation);
        add(" --sun-radius %.9g", o.radius);
    }
    out += " --size " + std::to_string(window_.size().width) + "x" + std::to_string(window_.size().height);
    if (!o.sky.empty()) out += " --sky " + quoted(o.sky);
    if (!o.lights.empty()) out += " --lights " + quoted(o.lights);
    if (o.punctualRadius > 0) add(" --punctual-radius %.9g", o.punctualRadius);
    if (o.exposure != 0) add(" --exposure %.9g", o.exposure);
    if (!o.tone.empty()) out += " --tone " + o.tone;
    if (o.plain && o.albedo.empty()) out += " --plain";
    if (!o.albedo.empty()) out += " --albedo " + o.albedo;
    if (o.bounces > 0 && settings.models[0]) out += " --bounces " + std::to_string(o.bounces);
    if (o.bounces > 0 && settings.models[0] && !o.around.empty() && !o.plain) out += " --around " + o.around;
    if (lampsMoved_) out += "  # lamps were moved since";
    if (!hasVisibility(asset_.scene)) out += "  # of this scene, baked: apertura bake";
    return out;
}

}  // namespace apertura
