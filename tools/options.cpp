#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "apertura/bake/scene/ground.h"
#include "apertura/runtime/asset/asset.h"
#include "apertura/runtime/asset/error.h"
#include "tools/commands.h"

namespace apertura {

CLI::Validator finiteRange(double low, double high) {
    return CLI::Validator(
        [low, high](std::string& text) {
            const std::vector<double> value = parseNumbers(text, ',');
            const bool inside = value.size() == 1 && value[0] >= low && value[0] <= high;
            std::ostringstream message;
            message << "'" << text << "' is not a number from " << low << " to " << high;
            return inside ? std::string() : message.str();
        },
        "");
}

std::string findScript(const std::string& name) {
    std::error_code failed;
    const std::filesystem::path own = std::filesystem::read_symlink("/proc/self/exe", failed).parent_path();
    if (failed) throw Error(name + ": /proc/self/exe does not tell where this program is, beside which its scripts are");
    const std::filesystem::path installed = (own / APERTURA_SCRIPTS).lexically_normal();
    for (const std::filesystem::path& folder : {own, installed})
        if (std::filesystem::is_regular_file(folder / name)) return (folder / name).string();
    throw Error(name + ": is neither in " + own.string() + " nor in " + installed.string() + ", where this program looks for its scripts");
}

void drawCharts(const std::string& script, const std::string& folder, const std::string& otherwise) {
    std::fflush(stdout);
    const char* const python = std::getenv("APERTURA_PYTHON");
    const std::string command = std::string(python ? python : "/usr/bin/python3") + " \"$APERTURA_SCRIPT\" \"$APERTURA_CHART_FOLDER\"";
    setenv("APERTURA_SCRIPT", script.c_str(), 1);
    setenv("APERTURA_CHART_FOLDER", folder.c_str(), 1);
    if (std::system(command.c_str()) != 0) throw Error(folder + ": " + otherwise);
}

void dropRepeats(std::vector<double>& numbers) {
    std::vector<double> kept;
    for (double x : numbers)
        if (std::find(kept.begin(), kept.end(), x) == kept.end()) kept.push_back(x);
    numbers = kept;
}

std::string modelNames() {
    std::string out;
    for (const Model& model : models()) out += (out.empty() ? "" : ", ") + std::string(model.name);
    return out;
}

std::vector<const Model*> parseModels(const std::vector<std::string>& names, bool& shadowMap) {
    std::vector<const Model*> out;
    shadowMap = names.empty();
    for (const std::string& name : names) {
        const Model* model = findModel(name);
        if (name == "shadow-map")
            shadowMap = true;
        else if (!model)
            throw CLI::ValidationError("there is no model '" + name + "' (there are " + modelNames() + ", shadow-map)");
        else
            out.push_back(model);
    }
    return out;
}

void requireAuto(const std::vector<std::string>& models) {
    if (!models.empty() && std::find(models.begin(), models.end(), "auto") == models.end())
        throw CLI::ValidationError("--tolerance is for the model auto, which is not among --models");
}

void printNotes(const std::vector<std::string>& notes) {
    for (const std::string& note : notes) std::printf("  %s\n", printable(note).c_str());
}

std::string printable(std::string text) {
    for (char& c : text)
        if (uint8_t(c) < 0x20 || c == 0x7F) c = ' ';
    return text;
}

void refuseToReplaceInput(const std::string& in, const std::string& out) {
    std::error_code ignored;
    if (std::filesystem::equivalent(in, out, ignored)) throw CLI::ValidationError("the output " + out + " is the input itself");
}

std::vector<double> parseNumbers(const std::string& text, char separator) {
    std::vector<double> out;
    const char *at = text.data(), *end = at + text.size();
    for (;;) {
        double value = 0;
        const auto [next, error] = std::from_chars(at, end, value);
        if (error != std::errc() || !std::isfinite(value)) return {};
        out.push_back(value);
        if (next == end) return out;
        if (*next != separator) return {};
        at = next + 1;
    }
}

void parsePair(const std::string& option, const std::string& text, double& first, double& second) {
    const std::vector<double> numbers = parseNumbers(text, 'x');
    const bool right = (numbers.size() == 1 || numbers.size() == 2) && numbers.front() > 0 && numbers.back() > 0;
    if (!right) throw CLI::ValidationError(option + ": '" + text + "' is not a positive number, nor two of them as in 2x3");
    first = numbers.front();
    second = numbers.back();
}

void addHeightMapOptions(CLI::App& command, HeightMapOptions& options) {
    const char* group = "Height maps";
    command
        .add_option_function<std::string>(
            "--spacing", [&options](const std::string& text) { parsePair("--spacing", text, options.spacingX, options.spacingZ); },
            "metres of ground between texels, or EASTxSOUTH [as a GeoTIFF says, else 1]")
        ->type_name("M")
        ->group(group);
    command.add_option("--vertical-scale", options.verticalScale, "metres a unit of height [1]")
        ->check(finiteRange(1e-9, 1e9))
        ->type_name("S")
        ->group(group);
    command.add_flag("--terrain-rgb", options.terrainRgb, "heights are packed in R, G, B (Mapbox Terrain-RGB)")->group(group);
}

void SceneOptions::addTo(CLI::App& to) {
    command = &to;
    to.add_flag("--ground", ground, "put a ground under a scene that has none: a square, four times as wide as the scene");
    addHeightMapOptions(to, heights);
}

void SceneOptions::check(const std::string& scene) const {
    for (const char* const own : {"--spacing", "--vertical-scale", "--terrain-rgb"})
        if (command->count(own) > 0 && !isHeightMap(scene))
            throw CLI::ValidationError(std::string(own) + " is for height maps, and " + scene + " is none");
    if (ground && isHeightMap(scene)) throw CLI::ValidationError("--ground: " + scene + " is a height map, which is a ground itself");
}

Scene SceneOptions::load(const std::string& scene, Coordinates coordinates) const {
    check(scene);
    Scene out = loadScene(scene, heights, coordinates);
    if (!ground) return out;
    if (hasVisibility(out)) throw Error(scene + ": is baked already: bake its source with --ground");
    return withGround(std::move(out));
}

std::string inQuotes(const std::string& text) {
    std::string out = "\"";
    for (char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + "\"";
}

std::optional<glm::vec3> albedoIn(const std::string& text) {
    const std::vector<double> n = parseNumbers(text, ',');
    const bool right = (n.size() == 1 || n.size() == 3) && std::all_of(n.begin(), n.end(), [](double a) { return a >= 0 && a <= 1; });
    if (!right) return std::nullopt;
    return n.size() == 1 ? glm::vec3(float(n[0])) : glm::vec3(n[0], n[1], n[2]);
}

CLI::Validator isAlbedo(const std::vector<std::string>& words) {
    return CLI::Validator(
        [words](std::string& text) {
            if (albedoIn(text) || std::find(words.begin(), words.end(), text) != words.end()) return std::string();
            std::string message = "'" + text + "' is neither ";
            for (const std::string& word : words) message += word + ", ";
            return message + "A nor R,G,B, each from 0 to 1";
        },
        "");
}

}  // namespace apertura
