#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/gtc/color_space.hpp>
#include <numbers>

#include "apertura/bake/measure/reference.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/file.h"
#include "apertura/runtime/render/renderer.h"
#include "tools/commands.h"
#include "tools/terminal.h"

namespace apertura {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
// Irradiance of a surface that faces the sun, W/m2. With View's default sky the picture needs no exposure control.
constexpr double kSunIrradiance = 2.4;

struct Arguments {
    std::string file, out, model, sky, camera;
    double azimuth = 135, elevation = 40, radius = 0.27;
    double width = 960, height = 540;
    std::string lightAt;
    uint32_t seed = 1;
    int threads = 0;
    HeightMapOptions map;
};

glm::vec3 parseColour(const std::string& text) {
    if (text.size() != 6 || text.find_first_not_of("0123456789abcdefABCDEF") != std::string::npos)
        throw CLI::ValidationError("--sky: '" + text + "' is not a colour RRGGBB");
    const unsigned long value = std::stoul(text, nullptr, 16);
    return glm::convertSRGBToLinear(glm::dvec3(value >> 16 & 255, value >> 8 & 255, value & 255) / 255.0);
}

Camera parseCamera(const std::string& text, const Camera& fallback) {
    if (text.empty()) return fallback;
    const std::vector<double> n = parseNumbers(text, ',');
    const bool near = std::all_of(n.begin(), n.end(), [](double x) { return std::abs(x) < 1e15; });
    const bool right = near && (n.size() == 6 || (n.size() == 7 && n[6] > 0 && n[6] < 179))
                    && glm::vec3(n[0], n[1], n[2]) != glm::vec3(n[3], n[4], n[5]);
    if (!right) throw CLI::ValidationError("--camera: '" + text + "' is not EX,EY,EZ,TX,TY,TZ[,FOV], eye and target apart");
    return {glm::vec3(n[0], n[1], n[2]), glm::vec3(n[3], n[4], n[5]), n.size() == 7 ? float(n[6] * kDegree) : fallback.verticalFov};
}

AperturaLight sun(const Arguments& a) {
    const double azimuth = a.azimuth * kDegree, elevation = a.elevation * kDegree, radius = a.radius * kDegree;
    // Azimuth from north (-Z) towards east (+X).
    const glm::vec3 direction(std::cos(elevation) * std::sin(azimuth), std::sin(elevation), -std::cos(elevation) * std::cos(azimuth));
    const double radiance = kSunIrradiance / (std::numbers::pi * std::sin(radius) * std::sin(radius));
    return directionalLight(direction, radius, glm::vec3(radiance * glm::dvec3(1, 0.93, 0.82)));
}

void run(const Arguments& a) {
    const Model* model = findModel(a.model);
    const bool own = a.model.empty();  // use the model that the asset stores
    if (!model && !own && a.model != "reference" && a.model != "shadow-map")
        throw CLI::ValidationError("--model: there is no model '" + a.model + "' (there are " + modelNames() + ", shadow-map, reference)");
    if (!a.lightAt.empty() && (a.model == "reference" || a.model == "shadow-map"))
        throw CLI::ValidationError("--light-at is for the models: " + a.model + " lights pixels");
    View view;
    view.width = int(a.width);
    view.height = int(a.height);
    if (view.width != a.width || view.height != a.height || std::max(view.width, view.height) > 8192)
        throw CLI::ValidationError("--size: whole numbers of pixels, at most 8192");
    if (!a.sky.empty()) view.sky = parseColour(a.sky);
    view.lights = {sun(a)};
    parseCamera(a.camera, {});
    refuseToReplaceInput(a.file, a.out);
    requireWritable(a.out);
    Scene scene = loadScene(a.file, a.map);
    view.camera = parseCamera(a.camera, viewOf(scene));
    Picture picture;
    std::vector<std::string> notes = scene.notes;
    if (model || own || a.model == "shadow-map") {
        const Asset asset = toAsset(std::move(scene));
        notes = asset.scene.notes;
        if (own) model = storedModel(asset.info);
        if (own && !model) model = findModel("soft");
        if (a.lightAt == "vertices" && hasSamplesOnFaces(asset))
            throw Error(a.file + ": has samples on its faces, which --light-at vertices would leave out; bake it with --at vertices");
        if (a.lightAt == "vertices" && hasTexels(asset))
            throw Error(a.file + ": has images, which --light-at vertices would leave out; bake it with --at vertices");
        const Gpu gpu;
        Renderer renderer(gpu, asset);
        if (model) {
            const LightAt better = renderer.betterLightAt(*model, 4.0 * view.width * view.height);
            const LightAt at = a.lightAt == "vertices" ? LightAt::Vertices : a.lightAt == "pixels" ? LightAt::Pixels : better;
            picture = renderer.draw(view, *model, at);
        } else {
            picture = renderer.drawShadowMapped(view);
        }
    } else {
        ProgressBar bar("ray tracing");
        const Progress progress = bar.callback();
        ReferenceOptions options;
        options.seed = a.seed;
        options.threads = a.threads;
        picture = traceReference(Tracer(scene, progress), view, options, progress);
    }
    if (interrupted()) throw Cancelled{};
    writePicture(a.out, picture);
    std::printf("%s: %d x %d, %s\n", a.out.c_str(), view.width, view.height, model ? std::string(model->name).c_str() : a.model.c_str());
    printNotes(notes);
}

}  // namespace

void addRenderCommand(CLI::App& program) {
    auto a = std::make_shared<Arguments>();
    CLI::App& command = *program.add_subcommand("render", "draw a baked asset with Vulkan, or any scene ray traced");
    command.footer("Example: apertura render statue.glb -o dawn.png --model soft --sun-azimuth 90 --sun-elevation 8");
    command.add_option("FILE", a->file, "a baked .glb; with --model reference any scene as for bake")->required();
    command.add_option("-o", a->out, "the picture, .png (sRGB) or .exr (linear)")->required()->type_name("PICTURE");
    command.add_option("--model", a->model, modelNames() + ", or the baselines shadow-map: percentage-closer soft shadows, and reference: ray traced [what the asset stores, or soft]")->type_name("NAME");
    command.add_option("--sun-azimuth", a->azimuth, "degrees from north (-Z) by east (+X) [135]")
        ->check(finiteRange(-360.0, 360.0))
        ->type_name("D");
    command.add_option("--sun-elevation", a->elevation, "degrees above the horizon [40]")->check(finiteRange(-90.0, 90.0))->type_name("D");
    command.add_option("--sun-radius", a->radius, "degrees [0.27]")->check(finiteRange(0.01, 45.0))->type_name("D");
    command.add_option("--sky", a->sky, "the sky's colour, sRGB [5d7cac]")->type_name("RRGGBB");
    command
        .add_option_function<std::string>(
            "--size", [a](const std::string& text) { parsePair(text, a->width, a->height); }, "pixels [960x540]")
        ->type_name("WxH");
    command
        .add_option(
            "--light-at", a->lightAt,
            "where light is evaluated: once a vertex and frame, or at every pixel [vertices, where the model does not mix and they are "
            "fewer than three times the pixels]")
        ->check(CLI::IsMember({"vertices", "pixels"}))
        ->type_name("vertices|pixels");
    command.add_option("--camera", a->camera, "eye, target and vertical field of view in degrees [the asset's own, or all of it]")
        ->type_name("EX,EY,EZ,TX,TY,TZ[,FOV]");
    command.add_option("--seed", a->seed, "of the reference's rays [1]")->type_name("S");
    command.add_option("--threads", a->threads, "for the reference [all cores]")->check(CLI::Range(1, 1024))->type_name("T");
    addHeightMapOptions(command, a->map);
    command.callback([a] { run(*a); });
}

}  // namespace apertura
