#include <oneapi/tbb/global_control.h>

#include <cstdio>
#include <filesystem>

#include "apertura/bake/fit/terrain.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/materials.h"
#include "apertura/runtime/asset/texels.h"
#include "tools/terminal.h"
#include "tools/terrain.h"
#include "tools/view/script.h"
#include "tools/view/viewer.h"

namespace apertura {
namespace {

struct Arguments {
    std::string file, model, script, save;
    ViewOptions view;
    bool validate = false;
    SceneOptions reading;
};

// A height map's: swept, as `bake` does it.
Asset sweptAsset(Scene scene, const HeightMap& map, double meshError, BakeOptions options) {
    Asset out;
    out.info.model = options.recipe;
    out.info.scene = scene.name;
    out.info.meshError = meshError;
    out.info.at = options.at == At::Texels ? "texels" : "vertices";
    {
        ProgressBar bar("baking");
        TerrainReport report;
        out.seen = bakeTerrain(scene, map.field, options, {}, bar.callback(), nullptr, &report);
        out.info.azimuths = report.azimuths;
    }
    // What readers of an asset find in its mesh.
    for (size_t i = 0; i < out.seen.size(); ++i)
        if (SeenOnTexels& texels = out.seen[i].texels; !texels.visibility.empty())
            setTexelNormals(scene, i, mapTexels(scene.surfaces[i], texels.width, texels.height), texels);
    out.scene = std::move(scene);
    return out;
}

// What `bake` takes for granted, with the model that is asked for.
BakeOptions optionsOf(const Arguments& a) {
    BakeOptions out;
    out.recipe = findRecipe(a.model.empty() || !findRecipe(a.model) ? "sh" : a.model)->name;
    if (!isHeightMap(a.file)) out.rays = defaultRays(recipeNamed(out.recipe));
    if (isHeightMap(a.file)) out.at = out.recipe == "sh" ? At::Texels : At::Vertices;
    return out;
}

// A scene's asset: as the file has it, or baked now with all that `bake` takes for granted.
Asset assetOf(Scene scene, const Arguments& a) {
    if (hasVisibility(scene)) return toAsset(std::move(scene));
    const BakeOptions options = optionsOf(a);
    Asset out;
    out.info.model = options.recipe;
    out.info.scene = scene.name;
    {
        ProgressBar bar("baking");
        const Progress progress = bar.callback();
        out.seen = bakeScene(scene, Tracer(scene, progress), options, progress);
    }
    out.info.at = options.at == At::Faces ? "faces" : "vertices";
    out.scene = std::move(scene);
    return out;
}

void run(const Arguments& a) {
    a.view.check();
    const Model* const model = findModel(a.model);
    if (!a.model.empty() && !model && a.model != "shadow-map" && !findRecipe(a.model))
        throw CLI::ValidationError("--model: there is no model '" + a.model + "' (there are " + modelNames() + ", shadow-map)");
    if (!a.save.empty() && a.script.empty()) throw CLI::ValidationError("--save is for --script");
    if (!a.save.empty() && !std::filesystem::is_directory(a.save)) throw Error(a.save + ": is no folder");
    std::optional<Script> script;
    if (!a.script.empty()) script.emplace(a.script, a.save);
    HeightMap map;
    double meshError = 0;
    Scene scene;
    if (isHeightMap(a.file)) {
        a.reading.check(a.file);
        map = loadHeights(a.file, a.reading.heights);
        // The view may name files too, and all are read before the first thread begins.
        const tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
        scene = meshToSweep(a.file, map, optionsOf(a).at == At::Texels, -1, meshError);
    } else {
        scene = a.reading.load(a.file);
    }
    loadTextures(scene, TexturesFor::Pictures);
    std::vector<std::string> notes = scene.notes;
    const View view = a.view.viewOf(scene, notes);
    const bool isBaked = hasVisibility(scene);
    const Asset asset = isHeightMap(a.file) ? sweptAsset(std::move(scene), map, meshError, optionsOf(a)) : assetOf(std::move(scene), a);
    if (!isBaked) std::printf("%s: baked for this window alone; `apertura bake` keeps it\n", a.file.c_str());
    printNotes(notes);
    Window window("apertura - " + a.file, int(a.view.width), int(a.view.height), a.validate);
    bool ended = false;
    {
        Viewer viewer(window, asset, a.file, a.view, view);
        if (model || a.model == "shadow-map") viewer.setModel(0, a.model);
        if (script) viewer.settings.panel = false;
        while (!viewer.isDone() && !interrupted()) {
            if (!window.poll([&](const SDL_Event& event) { viewer.handle(event); })) break;
            if (script && (ended = !script->step(viewer))) break;
            viewer.frame(script.has_value());
        }
    }
    if (interrupted()) throw Cancelled{};
    if (script && !ended) throw Error(a.script + ": the window was closed before its end");
    for (const std::string& message : window.gpu().messages()) std::fprintf(stderr, "validation: %s\n", message.c_str());
    if (!window.gpu().messages().empty()) throw Error("Vulkan: the validation layer has found faults");
}

}  // namespace

void addViewCommand(CLI::App& program) {
    auto a = std::make_shared<Arguments>();
    CLI::App& command = *program.add_subcommand("view", "show a scene in a window: move the sun, switch models, compare with truth");
    command.footer(std::string("Keys and mouse:\n") + kViewerKeys + "\n\nScripts, a command a line; the panel is hidden:\n"
                   + kScriptCommands + "\nA scene that is not baked is baked first.\nExample: apertura view arcade.glb --sun-elevation 25");
    command.add_option("FILE", a->file, "a baked .glb, or any scene as for bake")->required();
    command.add_option("--model", a->model, modelNames() + ", or shadow-map [what the asset stores, or soft]")->type_name("NAME");
    a->view.addTo(command);
    command.add_option("--script", a->script, "replay keys, mouse and waits from a text file, and end")->type_name("FILE");
    command.add_option("--save", a->save, "where the script's pictures go")->type_name("DIR");
    command.add_flag("--validate", a->validate, "load the Vulkan validation layer and fail if it finds anything");
    a->reading.addTo(command);
    command.callback([a] { run(*a); });
}

}  // namespace apertura
