#pragma once
// The verbs of the command line. Each function adds a verb with its options and the callback that runs it.
#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "apertura/bake/scene/load.h"
#include "apertura/sh/models.h"

namespace apertura {

void addBakeCommand(CLI::App& program);
void addHorizonCommand(CLI::App& program);
void addInfoCommand(CLI::App& program);
void addRenderCommand(CLI::App& program);
void addCompareCommand(CLI::App& program);
void addChartCommand(CLI::App& program);
void addStabilityCommand(CLI::App& program);
void addViewCommand(CLI::App& program);

// Adds --spacing, --vertical-scale and --terrain-rgb. `options` must outlive `command`.
void addHeightMapOptions(CLI::App& command, HeightMapOptions& options);

// How a verb reads scenes.
struct SceneOptions {
    HeightMapOptions heights;
    bool ground = false;  // with one under it
    const CLI::App* command = nullptr;

    // Adds the options. It must outlive `command`.
    void addTo(CLI::App& to);
    // Throws CLI::ValidationError where an option is not for scenes of this kind.
    void check(const std::string& scene) const;
    // check and loadScene.
    Scene load(const std::string& scene, Coordinates coordinates = Coordinates::Ignore) const;
};

// Removes repeated numbers and keeps the first of each.
void dropRepeats(std::vector<double>& numbers);

// The names of all visibility models, separated by commas.
std::string modelNames();

// The models of a list of names, for --models; `shadowMap` becomes true if that baseline is among them, or if the list is empty. Throws
// CLI::ValidationError for a name that is no model's.
std::vector<const Model*> parseModels(const std::vector<std::string>& names, bool& shadowMap);

// For --tolerance: throws CLI::ValidationError unless auto is among these models, or all are meant because the list is empty.
void requireAuto(const std::vector<std::string>& models);

// The finite numbers of a text such as "1,2.5,3"; empty if it is anything else.
std::vector<double> parseNumbers(const std::string& text, char separator);

// Accepts low .. high, as CLI::Range does, but not NaN, which that lets through.
CLI::Validator finiteRange(double low, double high);

// The path of a script that the program runs, wherever the program was moved to: beside it, as in a build tree, or in ../share/apertura or
// what else the install was told. Throws Error naming the script and both folders if it is in neither. Call it before the work.
std::string findScript(const std::string& name);

// Runs a Python script that draws charts of the tables in a folder.
//   script     from findScript; it reports itself if a package is missing
//   otherwise  added to the Error, which also names the folder, that this throws if the script fails
void drawCharts(const std::string& script, const std::string& folder, const std::string& otherwise);

// Text from a file in one line, without the characters that control a terminal.
std::string printable(std::string text);

// A cell of a table of comma-separated values.
std::string inQuotes(const std::string& text);

// Prints notes about a file, a line each.
void printNotes(const std::vector<std::string>& notes);

// Throws CLI::ValidationError if writing `out` would replace `in`.
void refuseToReplaceInput(const std::string& in, const std::string& out);

// Parses "2.5x3", or "2.5" for two equal numbers. Throws CLI::ValidationError, which begins with the option's name, unless they are above
// 0.
void parsePair(const std::string& option, const std::string& text, double& first, double& second);

// An albedo A or R,G,B, each 0..1; nothing if the text is neither.
std::optional<glm::vec3> albedoIn(const std::string& text);

// What CLI11 says of an option of which the text is none, nor one of `words`.
CLI::Validator isAlbedo(const std::vector<std::string>& words = {});

}  // namespace apertura
