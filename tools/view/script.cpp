#include "tools/view/script.h"

#include <SDL.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <sstream>

#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/file.h"

namespace apertura {
namespace {

constexpr double kLongest = 600;  // seconds
constexpr double kMost = 1e5;     // of a number in a line

// How many words follow each command: at least and at most.
const std::map<std::string, std::pair<size_t, size_t>> kCommands{
    {"key", {1, 1}}, {"drag", {5, 5}}, {"click", {2, 2}},  {"wheel", {1, 1}}, {"model", {1, 1}}, {"second", {1, 1}},
    {"sun", {2, 2}}, {"wait", {0, 1}}, {"frames", {1, 1}}, {"save", {1, 1}},  {"line", {0, 0}},  {"clock", {0, 0}}};

Uint32 buttonOf(const std::string& name) {
    return name == "left" ? SDL_BUTTON_LEFT : name == "middle" ? SDL_BUTTON_MIDDLE : name == "right" ? SDL_BUTTON_RIGHT : 0;
}

bool isNumber(const std::string& text) { return parseNumbers(text, ',').size() == 1; }
double numberIn(const std::string& text) { return parseNumbers(text, ',').at(0); }

// The key and its modifiers; 0: there is none of that name.
std::pair<SDL_Keycode, int> keyOf(std::string name) {
    int modifiers = 0;
    for (const auto& [prefix, modifier] :
         {std::pair<std::string, int>("ctrl+", KMOD_LCTRL), std::pair<std::string, int>("shift+", KMOD_LSHIFT)})
        if (name.starts_with(prefix)) name.erase(0, prefix.size()), modifiers |= modifier;
    return {SDL_GetKeyFromName(name.c_str()), modifiers};
}

void pushMotion(double x, double y, double right, double down, Uint32 button) {
    SDL_Event event{};
    event.type = SDL_MOUSEMOTION;
    event.motion.state = SDL_BUTTON(button);
    event.motion.x = int(x), event.motion.y = int(y);
    event.motion.xrel = int(right), event.motion.yrel = int(down);
    SDL_PushEvent(&event);
}

void pushButton(Uint32 type, double x, double y, Uint32 button, int clicks) {
    SDL_Event event{};
    event.type = type;
    event.button.button = Uint8(button);
    event.button.clicks = Uint8(clicks);
    event.button.x = int(x), event.button.y = int(y);
    SDL_PushEvent(&event);
}

}  // namespace

Script::Script(const std::string& path, std::string folder) : path_(path), folder_(std::move(folder)) {
    const std::vector<unsigned char> bytes = readFile(path);
    std::istringstream text(std::string(bytes.begin(), bytes.end()));
    std::string line;
    for (int number = 1; std::getline(text, line); ++number) {
        std::istringstream words(line);
        Line out{number, {}};
        for (std::string word; words >> word;) out.words.push_back(word);
        if (out.words.empty() || out.words[0].starts_with('#')) continue;
        const auto known = kCommands.find(out.words[0]);
        if (known == kCommands.end()) fail(out, "there is no command '" + out.words[0] + "'");
        const size_t given = out.words.size() - 1;
        if (given < known->second.first || given > known->second.second) fail(out, "'" + out.words[0] + "' has too few or too many words");
        const std::string& command = out.words[0];
        const bool onlyNumbers = command == "click" || command == "wheel" || command == "sun" || command == "frames";
        for (size_t i = 1; i < out.words.size(); ++i)
            if ((onlyNumbers || (command == "drag" && i > 1) || (command == "wait" && out.words[i] != "converged"))
                && !isNumber(out.words[i]))
                fail(out, "'" + out.words[i] + "' is not a number");
        for (size_t i = 1; i < out.words.size(); ++i)
            if (isNumber(out.words[i]) && std::abs(numberIn(out.words[i])) > kMost) fail(out, "'" + out.words[i] + "' is too large");
        if (command == "frames" && !(numberIn(out.words[1]) >= 1 && numberIn(out.words[1]) == std::floor(numberIn(out.words[1]))))
            fail(out, "'" + out.words[1] + "' is not a number of frames");
        if (command == "sun" && (std::abs(numberIn(out.words[1])) > 360 || std::abs(numberIn(out.words[2])) > 90))
            fail(out, "azimuths are -360 to 360 degrees, elevations -90 to 90");
        if (command == "drag" && buttonOf(out.words[1]) == 0) fail(out, "there is no button '" + out.words[1] + "'");
        if (command == "key" && keyOf(out.words[1]).first == 0) fail(out, "there is no key '" + out.words[1] + "'");
        if (command == "save") {
            const std::filesystem::path name(out.words[1]);
            if (name.has_parent_path() || (name.extension() != ".png" && name.extension() != ".exr"))
                fail(out, "'" + out.words[1] + "' is not the name of a .png or .exr");
            if (folder_.empty()) fail(out, "pictures are saved with --save DIR");
        }
        lines_.push_back(out);
    }
}

void Script::fail(const Line& line, const std::string& cause) const {
    throw Error(path_ + ":" + std::to_string(line.number) + ": " + cause);
}

bool Script::step(Viewer& viewer) {
    while (next_ < lines_.size()) {
        const bool first = !begun_;
        if (first) {
            begun_ = true;
            since_ = std::chrono::steady_clock::now();
            before_ = viewer.window().gpu().counters();
            frames_ = 0;
        }
        if (!isOver(viewer, lines_[next_])) return true;
        begun_ = false;
        ++next_;
    }
    return false;
}

bool Script::isOver(Viewer& viewer, const Line& line) {
    const std::vector<std::string>& w = line.words;
    const double waited = std::chrono::duration<double>(std::chrono::steady_clock::now() - since_).count();
    if (waited > kLongest) fail(line, "took longer than ten minutes");
    ++frames_;
    if (w[0] == "key") {
        const auto [key, modifiers] = keyOf(w[1]);
        SDL_Event event{};
        event.type = SDL_KEYDOWN;
        event.key.keysym = {SDL_GetScancodeFromKey(key), key, Uint16(modifiers), 0};
        SDL_PushEvent(&event);
    } else if (w[0] == "drag") {
        const Uint32 button = buttonOf(w[1]);
        const double x0 = numberIn(w[2]), y0 = numberIn(w[3]), x1 = numberIn(w[4]), y1 = numberIn(w[5]);
        pushButton(SDL_MOUSEBUTTONDOWN, x0, y0, button, 1);
        pushMotion(x1, y1, x1 - x0, y1 - y0, button);
        pushButton(SDL_MOUSEBUTTONUP, x1, y1, button, 1);
    } else if (w[0] == "click") {
        pushButton(SDL_MOUSEBUTTONDOWN, numberIn(w[1]), numberIn(w[2]), SDL_BUTTON_LEFT, 2);
        pushButton(SDL_MOUSEBUTTONUP, numberIn(w[1]), numberIn(w[2]), SDL_BUTTON_LEFT, 2);
    } else if (w[0] == "wheel") {
        SDL_Event event{};
        event.type = SDL_MOUSEWHEEL;
        event.wheel.preciseY = float(numberIn(w[1]));
        event.wheel.y = int(numberIn(w[1]));
        SDL_PushEvent(&event);
    } else if (w[0] == "model" || w[0] == "second") {
        try {
            viewer.setModel(w[0] == "second", w[1]);
        } catch (const Error& e) {
            fail(line, e.what());
        }
    } else if (w[0] == "sun") {
        viewer.settings.light.azimuth = numberIn(w[1]), viewer.settings.light.elevation = numberIn(w[2]);
    } else if (w[0] == "wait" && w.size() == 1) {
        return frames_ > 2 && viewer.isSettled();
    } else if (w[0] == "wait" && w[1] == "converged") {
        return frames_ > 2 && viewer.truth && viewer.truth->isConverged;
    } else if (w[0] == "wait") {
        return waited >= numberIn(w[1]);
    } else if (w[0] == "frames") {
        if (frames_ <= int(numberIn(w[1]))) {
            viewer.settings.light.azimuth = std::fmod(viewer.settings.light.azimuth + 0.7, 360);
            viewer.moveLamps(frames_ % 20 < 10 ? 0.01 : -0.01);
            return false;
        }
        const GpuCounters after = viewer.window().gpu().counters();
        std::printf("{\"frames\": %d, \"pipelines\": %llu, \"allocations\": %llu, \"copies\": %llu, \"seconds\": %.3f}\n",
                    int(numberIn(w[1])), static_cast<unsigned long long>(after.pipelines - before_.pipelines),
                    static_cast<unsigned long long>(after.allocations - before_.allocations),
                    static_cast<unsigned long long>(after.copiesToHost - before_.copiesToHost), waited);
        std::fflush(stdout);
    } else if (w[0] == "clock") {
        const auto now = std::chrono::steady_clock::now();
        std::printf("%.3f s\n", std::chrono::duration<double>(now - clock_).count());
        clock_ = now;
    } else if (w[0] == "line") {
        std::printf("%s\n", viewer.renderLine().c_str());
        std::fflush(stdout);
    } else if (w[0] == "save") {
        viewer.save((std::filesystem::path(folder_) / w[1]).string());
    }
    return true;
}

}  // namespace apertura
