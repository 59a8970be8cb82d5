#pragma once
// The verbs of the command line. Each adds its options to the program and says what to run.
#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "bake/scene/load.h"

namespace apertura {

void addBakeCommand(CLI::App& program);
void addInfoCommand(CLI::App& program);
void addRenderCommand(CLI::App& program);
void addCompareCommand(CLI::App& program);
void addChartCommand(CLI::App& program);
void addStabilityCommand(CLI::App& program);

// --spacing, --vertical-scale and --terrain-rgb, for the verbs that read scenes.
void addHeightMapOptions(CLI::App& command, HeightMapOptions& options);

// Keeps the first of equal numbers.
void dropRepeats(std::vector<double>& numbers);

// The names of all visibility models, with commas.
std::string modelNames();

// The numbers of "1,2.5,3"; none where anything else stands there.
std::vector<double> parseNumbers(const std::string& text, char separator);

// As CLI::Range, but not for NaN, which no comparison excludes there.
CLI::Validator finiteRange(double low, double high);

// Runs a script of tools/ over the tables in a folder, with the Python that has matplotlib. Throws Error naming the
// folder and `otherwise` where it fails; it says itself what it lacks.
void drawCharts(const char* script, const std::string& folder, const std::string& otherwise);

// Text of a file, in one line and with nothing that a terminal takes for a command.
std::string printable(std::string text);

// Throws CLI::ValidationError where writing `out` would replace `in`.
void refuseToReplaceInput(const std::string& in, const std::string& out);

// "2.5" or "2.5x3": two positive numbers. Throws CLI::ValidationError.
void parsePair(const std::string& text, double& first, double& second);

}  // namespace apertura
