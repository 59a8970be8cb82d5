#include <cstdio>
#include <functional>
#include <optional>

#include "apertura/bake/measure/reference.h"
#include "apertura/runtime/asset/bounces.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/file.h"
#include "apertura/runtime/asset/materials.h"
#include "apertura/runtime/render/renderer.h"
#include "tools/film.h"
#include "tools/terminal.h"
#include "tools/view_options.h"

namespace apertura {
namespace {

struct Arguments {
    std::string file, out, model, lightAt;
    ViewOptions view;
    Film film;
    uint32_t seed = 1;
    int threads = 0, paths = 16;
    SceneOptions reading;
};

void run(const Arguments& a) {
    const Model* model = findModel(a.model);
    const bool own = a.model.empty();  // use the model that the asset stores
    if (!model && !own && a.model != "reference" && a.model != "shadow-map")
        throw CLI::ValidationError("--model: there is no model '" + a.model + "' (there are " + modelNames() + ", shadow-map, reference)");
    if (!a.lightAt.empty() && (a.model == "reference" || a.model == "shadow-map"))
        throw CLI::ValidationError("--light-at is for the models: " + a.model + " lights pixels");
    if (a.model == "shadow-map" && a.view.bounces > 0)
        throw CLI::ValidationError("--bounces: a shadow map knows no surfaces around a point");
    if (a.model == "reference" && !a.view.around.empty())
        throw CLI::ValidationError("--around is for models: the reference follows what is there");
    const bool linear = a.out.ends_with(".exr");
    if (linear && (a.view.exposure != 0 || !a.view.tone.empty()))
        throw CLI::ValidationError("--exposure and --tone are for .png: an .exr holds radiance itself");
    if (!linear && !a.out.ends_with(".png") && !a.film.isFilm(a.out))
        throw CLI::ValidationError("-o: pictures are .png or .exr" + std::string(a.film.frames > 0 ? ", films .mp4 or .webp" : ""));
    a.view.check();
    a.film.check(a.out);
    for (const std::string& in : {a.file, a.view.sky, a.view.lights})
        for (const std::string& out : a.film.filesOf(a.out))
            if (!in.empty()) refuseToReplaceInput(in, out);
    requireWritable(a.out);
    Scene scene = a.reading.load(a.file);
    if (!a.view.plain) loadTextures(scene, TexturesFor::Pictures);
    std::vector<std::string> notes = scene.notes, viewNotes;
    View view = a.view.viewOf(scene, viewNotes);
    if (view.bounces > 0 && a.model != "reference" && std::any_of(view.lights.begin(), view.lights.end(), aperturaIsSphere))
        viewNotes.push_back("light of lamps does not bounce in models; --model reference follows it");
    if (a.model == "shadow-map" && (view.lights.size() != 1 || a.view.noSun))
        throw Error("a shadow map is drawn of the sun alone: leave out --lights, --punctual-radius and --no-sun");
    std::optional<Asset> asset;
    std::optional<Gpu> gpu;
    std::optional<Renderer> renderer;
    std::optional<Tracer> tracer;
    std::function<Picture(const View&)> draw;
    if (model || own || a.model == "shadow-map") {
        asset = toAsset(std::move(scene));
        notes = asset->scene.notes;
        // What was baked without materials belongs to surfaces of one albedo.
        if (const auto baked = bakedAlbedo(asset->info); baked && !view.plain) view.albedo = *baked;
        if (view.bounces > 0 && a.view.around.empty() && !hasBounces(*asset))
            viewNotes.push_back(
                "what surfaces reflect is estimated from the four numbers: where none of the sky is seen it stays black; bake --bounce "
                "stores it");
        if (own) model = storedModel(asset->info);
        if (own && !model) model = findModel("soft");
        if (a.lightAt == "vertices" && hasSamplesOnFaces(*asset))
            throw Error(a.file + ": has samples on its faces, which --light-at vertices would leave out; bake it with --at vertices");
        if (a.lightAt == "vertices" && hasTexels(*asset))
            throw Error(a.file + ": has images, which --light-at vertices would leave out; bake it with --at vertices");
        gpu.emplace();
        renderer.emplace(*gpu, *asset);
        if (model) {
            const LightAt better = renderer->betterLightAt(*model, 4.0 * view.width * view.height);
            const LightAt at = a.lightAt == "vertices" ? LightAt::Vertices : a.lightAt == "pixels" ? LightAt::Pixels : better;
            draw = [&, at](const View& each) { return renderer->draw(each, *model, at); };
        } else {
            draw = [&](const View& each) { return renderer->drawShadowMapped(each); };
        }
    } else {
        tracer.emplace(scene, [](double) { return !interrupted(); });
        draw = [&](const View& each) {
            ProgressBar bar("ray tracing");
            ReferenceOptions options;
            options.seed = a.seed;
            options.threads = a.threads;
            options.paths = a.paths;
            return traceReference(*tracer, each, options, a.film.frames > 0 ? [](double) { return !interrupted(); } : bar.callback());
        };
    }
    const auto finished = [&](const View& each) {
        Picture picture = draw(each);
        if (interrupted()) throw Cancelled{};
        return linear ? picture : shown(std::move(picture), a.view.exposure, a.view.tone == "neutral");
    };
    if (a.film.frames == 0) {
        writePicture(a.out, finished(view));
    } else {
        a.film.write(a.out, [&](int frame) {
            View each = view;
            if (!a.film.sunPath.empty() && !a.view.noSun) {
                const auto [azimuth, elevation] = a.film.sunIn(frame);
                each.lights[0] = sunLight(azimuth, elevation, a.view.radius);
            }
            return finished(each);
        });
    }
    const std::string many = a.film.frames > 0 ? ", " + std::to_string(a.film.frames) + " frames" : "";
    std::printf("%s: %d x %d, %s%s\n", a.out.c_str(), view.width, view.height, model ? std::string(model->name).c_str() : a.model.c_str(),
                many.c_str());
    printNotes(notes);
    printNotes(viewNotes);
}

}  // namespace

void addRenderCommand(CLI::App& program) {
    auto a = std::make_shared<Arguments>();
    CLI::App& command = *program.add_subcommand("render", "draw a baked asset with Vulkan, or any scene ray traced");
    command.footer("Example: apertura render statue.glb -o dawn.png --model soft --sun-azimuth 90 --sun-elevation 8");
    command.add_option("FILE", a->file, "a baked .glb; with --model reference any scene as for bake")->required();
    command.add_option("-o", a->out, "the picture, .png (sRGB) or .exr (linear)")->required()->type_name("PICTURE");
    command.add_option("--model", a->model, modelNames() + ", or the baselines shadow-map: percentage-closer soft shadows, and reference: ray traced [what the asset stores, or soft]")->type_name("NAME");
    a->view.addTo(command);
    command
        .add_option(
            "--light-at", a->lightAt,
            "where light is evaluated: once a vertex and frame, or at every pixel [vertices, where the model does not mix and they are "
            "fewer than three times the pixels]")
        ->check(CLI::IsMember({"vertices", "pixels"}))
        ->type_name("vertices|pixels");
    command
        .add_option("--frames", a->film.frames, "draw so many frames: -o names them with %04d, or a film .mp4 or .webp, which ffmpeg makes")
        ->check(CLI::Range(1, 100000))
        ->type_name("N");
    command.add_option("--sun-path", a->film.sunPath, "where the sun goes meanwhile, through two points or more, degrees")
        ->type_name("AZ,EL:AZ,EL");
    command.add_option("--rate", a->film.rate, "frames a second of a film [24]")->check(finiteRange(0.1, 240.0))->type_name("F");
    command.add_option("--paths", a->paths, "of the reference's, with --bounces: of each of a pixel's 4 samples [16]")
        ->check(CLI::Range(1, 65536))
        ->type_name("N");
    command.add_option("--seed", a->seed, "of the reference's rays [1]")->type_name("S");
    command.add_option("--threads", a->threads, "for the reference [all cores]")->check(CLI::Range(1, 1024))->type_name("T");
    a->reading.addTo(command);
    command.callback([a, &command] {
        if (command.count("--sun-path") > 0 && a->film.sunPath.empty())
            throw CLI::ValidationError("--sun-path: '' is not AZ,EL:AZ,EL in degrees");
        if (command.count("--rate") > 0 && !a->film.isFilm(a->out)) throw CLI::ValidationError("--rate is for films, .mp4 or .webp");
        if (!a->film.sunPath.empty() && (command.count("--sun-azimuth") > 0 || command.count("--sun-elevation") > 0 || a->view.noSun))
            throw CLI::ValidationError("--sun-path says where the sun is: leave out --sun-azimuth, --sun-elevation and --no-sun");
        run(*a);
    });
}

}  // namespace apertura
