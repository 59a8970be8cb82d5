#include "tools/view_options.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/color_space.hpp>
#include <numbers>

#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/lights.h"
#include "apertura/runtime/asset/materials.h"

namespace apertura {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr float kBehind = 0.25f;  // of a plain sky's radiance, what is drawn behind a scene: what the sky lights stands apart from it

std::optional<glm::vec3> colourIn(const std::string& text) {
    const std::string digits = text.starts_with('#') ? text.substr(1) : text;
    if (digits.size() != 6 || digits.find_first_not_of("0123456789abcdefABCDEF") != std::string::npos) return std::nullopt;
    const unsigned long value = std::stoul(digits, nullptr, 16);
    return glm::convertSRGBToLinear(glm::dvec3(value >> 16 & 255, value >> 8 & 255, value & 255) / 255.0);
}

bool namesPicture(const std::string& text) {
    std::string ending = text.size() > 4 ? text.substr(text.size() - 4) : "";
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
    return ending == ".exr" || ending == ".hdr";
}

Camera cameraIn(const std::string& text, const Camera& fallback) {
    if (text.empty()) return fallback;
    const std::vector<double> n = parseNumbers(text, ',');
    const bool near = std::all_of(n.begin(), n.end(), [](double x) { return std::abs(x) < 1e15; });
    const bool right = near && (n.size() == 6 || (n.size() == 7 && n[6] > 0 && n[6] < 179))
                    && glm::vec3(n[0], n[1], n[2]) != glm::vec3(n[3], n[4], n[5]);
    if (!right) throw CLI::ValidationError("--camera: '" + text + "' is not EX,EY,EZ,TX,TY,TZ[,FOV], eye and target apart");
    return {glm::vec3(n[0], n[1], n[2]), glm::vec3(n[3], n[4], n[5]), n.size() == 7 ? float(n[6] * kDegree) : fallback.verticalFov};
}

}  // namespace

glm::vec3 sunDirection(double azimuth, double elevation) {
    const double a = azimuth * kDegree, e = elevation * kDegree;
    return {std::cos(e) * std::sin(a), std::sin(e), -std::cos(e) * std::cos(a)};
}

AperturaLight sunLight(double azimuth, double elevation, double radius) {
    constexpr double kIrradiance = 2.4;  // W/m2
    const double sine = std::sin(radius * kDegree);
    return directionalLight(sunDirection(azimuth, elevation), radius * kDegree,
                            glm::vec3(kIrradiance / (std::numbers::pi * sine * sine) * glm::dvec3(1, 0.93, 0.82)));
}

Picture shown(Picture picture, double exposure, bool toned) {
    const auto factor = float(std::exp2(exposure));
    for (glm::vec3& p : picture.pixels) p = toned ? aperturaNeutralTone(factor * p) : factor * p;
    return picture;
}

void ViewOptions::addTo(CLI::App& command) {
    command
        .add_option("--sun-azimuth", azimuth,
                    "degrees from north (-Z) by east (+X); its light is 2.4 W/m2 times (1, .93, .82) on what faces it [135]")
        ->check(finiteRange(-360.0, 360.0))
        ->type_name("D");
    command.add_option("--sun-elevation", elevation, "degrees above the horizon [40]")->check(finiteRange(-90.0, 90.0))->type_name("D");
    command.add_option("--sun-radius", radius, "degrees [0.27]")->check(finiteRange(0.01, 45.0))->type_name("D");
    command.add_flag("--no-sun", noSun, "only other lights and the sky");
    command
        .add_option("--sky", sky,
                    "the sky: one colour, sRGB, of which ffffff is 1 W/m2/sr, or an equirectangular picture, .exr or .hdr in W/m2/sr: its "
                    "middle is north (-Z), to its right "
                    "lies east (+X), its top row is up [5d7cac]")
        ->type_name("RRGGBB|FILE");
    command
        .add_option("--background", background,
                    "what is drawn where no surface is, whatever lights the scene [the sky's picture; of a plain sky a quarter of it]")
        ->type_name("sky|RRGGBB");
    command
        .add_option(
            "--lights", lights,
            "at most 16 more lights, a JSON list such as [{\"towards\": [0,1,0], \"radius\": 5, \"radiance\": [9,9,9]}, {\"at\": [0,2,0], "
            "\"radius\": 0.2, \"radiance\": [9,6,3]}]: at infinity with a radius in degrees, or a lamp in metres; radiance in "
            "W/m2/sr. One that faces a surface gives it pi sin^2(radius) times its radiance, the sun 2.4 W/m2 of red. Walls behind a "
            "lamp dim it too")
        ->type_name("FILE.json");
    command
        .add_option("--punctual-radius", punctualRadius,
                    "use the lights of the glTF file (KHR_lights_punctual), lamps as spheres of this many metres; 683 lm are 1 W")
        ->check(finiteRange(1e-6, 1e9))
        ->type_name("M");
    command.add_flag("--plain", plain, "all surfaces grey, as those of files without materials");
    command
        .add_option(
            "--albedo", albedo,
            "what all surfaces reflect, in place of their materials' base colours, 0..1 [theirs; 0.8 of those of files without materials]")
        ->check(isAlbedo())
        ->type_name("A|R,G,B");
    command
        .add_option("--bounces", bounces,
                    "light comes by way of other surfaces, too: the reference follows so many diffuse reflections, models estimate all of "
                    "them, of the sky and of lights at infinity [0]")
        ->check(CLI::Range(0, 1000))
        ->type_name("N");
    command
        .add_option("--around", around,
                    "what models take for the albedo of the surfaces that block the sky: the mean of the scene's, the surface's own, or "
                    "numbers, 0..1 [what was baked with --bounce, or mean]")
        ->check(isAlbedo({"mean", "own"}))
        ->type_name("mean|own|A|R,G,B");
    command.add_option("--exposure", exposure, "stops that a .png is brightened by; an .exr holds radiance itself [0]")
        ->check(finiteRange(-64.0, 64.0))
        ->type_name("EV");
    command
        .add_option("--tone", tone,
                    "radiances above 1 are cut off, or all are shown by the Khronos neutral curve, which darkens the dark a little [clamp]")
        ->check(CLI::IsMember({"clamp", "neutral"}))
        ->type_name("clamp|neutral");
    command
        .add_option_function<std::string>(
            "--size", [this](const std::string& text) { parsePair("--size", text, width, height); }, "pixels [960x540]")
        ->type_name("WxH");
    command.add_option("--camera", camera, "eye, target and vertical field of view in degrees [the file's own, or all of it]")
        ->type_name("EX,EY,EZ,TX,TY,TZ[,FOV]");
}

void ViewOptions::check() const {
    if (int(width) != width || int(height) != height || std::max(width, height) > 8192)
        throw CLI::ValidationError("--size: whole numbers of pixels, at most 8192");
    if (!sky.empty() && !colourIn(sky) && !namesPicture(sky))
        throw CLI::ValidationError("--sky: '" + sky + "' is neither a colour RRGGBB nor a picture .exr or .hdr");
    if (!background.empty() && background != "sky" && !colourIn(background))
        throw CLI::ValidationError("--background: '" + background + "' is neither a colour RRGGBB nor the word sky");
    if (!lights.empty() && punctualRadius > 0) throw CLI::ValidationError("--lights and --punctual-radius: one of them");
    if (!albedo.empty() && plain) throw CLI::ValidationError("--albedo and --plain: one of them");
    if (!around.empty() && (plain || !albedo.empty()))
        throw CLI::ValidationError("--around: with --plain and --albedo all surfaces have one albedo");
    if (!around.empty() && bounces == 0) throw CLI::ValidationError("--around is for light that bounces: give --bounces, too");
    cameraIn(camera, {});
}

View ViewOptions::viewOf(const Scene& scene, std::vector<std::string>& notes) const {
    View view;
    view.width = int(width);
    view.height = int(height);
    view.camera = camera.empty() ? apertura::viewOf(scene, width / height) : cameraIn(camera, {});
    if (const std::optional<glm::vec3> colour = colourIn(sky))
        view.sky = *colour;
    else if (!sky.empty())
        view.sky = readSky(sky);
    if (!background.empty() && background != "sky")
        view.background = *colourIn(background);
    else if (background.empty() && !view.sky.picture())
        view.background = kBehind * glm::vec3(view.sky.bands().bands[0]);
    view.plain = plain || !albedo.empty();
    if (!albedo.empty()) view.albedo = *albedoIn(albedo);
    view.bounces = bounces;
    view.around = around.empty() ? View::Around::Baked : around == "own" ? View::Around::Own : View::Around::Given;
    view.aroundAlbedo = around.empty() || around == "mean" || around == "own" ? meanAlbedo(scene, view.albedo) : *albedoIn(around);
    if (!noSun) view.lights.push_back(sunLight(azimuth, elevation, radius));
    std::vector<AperturaLight> more;
    if (!lights.empty()) more = readLights(lights);
    if (punctualRadius > 0) more = punctualLights(scene, punctualRadius, radius * kDegree, notes);
    view.lights.insert(view.lights.end(), more.begin(), more.end());
    return view;
}

}  // namespace apertura
