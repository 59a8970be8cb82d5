#include <cstdio>
#include <filesystem>

#include "apertura/bake/fit/bake.h"
#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/materials.h"
#include "tools/terminal.h"
#include "tools/view/script.h"
#include "tools/view/viewer.h"

namespace apertura {
namespace {

struct Arguments {
    std::string file, model, script, save;
    ViewOptions view;
    bool validate = false;
    HeightMapOptions map;
};

// A scene's asset: as the file has it, or baked now with all that `bake` takes for granted.
Asset assetOf(Scene scene, const Arguments& a) {
    if (hasVisibility(scene)) return toAsset(std::move(scene));
    BakeOptions options;
    const Recipe& recipe = *findRecipe(a.model.empty() || !findRecipe(a.model) ? "sh" : a.model);
    options.recipe = recipe.name;
    Asset out;
    out.info.model = recipe.name;
    out.info.scene = scene.name;
    {
        ProgressBar bar("baking");
        const Progress progress = bar.callback();
        out.seen = bakeScene(scene, Tracer(scene, progress), options, progress);
    }
    out.info.at = options.at == At::Faces ? "faces" : "vertices";
    out.scene = std::move(scene);
    std::printf("%s: baked for this window alone; `apertura bake` keeps it\n", a.file.c_str());
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
    Scene scene = loadScene(a.file, a.map);
    loadTextures(scene, TexturesFor::Pictures);
    // All files are read before the first thread begins.
    std::vector<std::string> notes = scene.notes;
    const View view = a.view.viewOf(scene, notes);
    const Asset asset = assetOf(std::move(scene), a);
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
    addHeightMapOptions(command, a->map);
    command.callback([a] { run(*a); });
}

}  // namespace apertura
