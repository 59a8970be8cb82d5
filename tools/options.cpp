#include <cmath>

#include "tools/commands.h"

namespace apertura {

void parsePair(const std::string& text, double& first, double& second) {
    size_t used = 0;
    try {
        first = second = std::stod(text, &used);
        if (used < text.size() && text[used] == 'x') {
            const std::string rest = text.substr(used + 1);
            second = std::stod(rest, &used);
            used = used == rest.size() ? text.size() : 0;
        }
    } catch (const std::exception&) {
        used = 0;
    }
    if (used != text.size() || !(first > 0) || !(second > 0) || !std::isfinite(first) || !std::isfinite(second))
        throw CLI::ValidationError("'" + text + "' is not a positive number, nor two of them as in 2x3");
}

void addHeightMapOptions(CLI::App& command, HeightMapOptions& options) {
    const char* group = "Height maps";
    command
        .add_option_function<std::string>(
            "--spacing", [&options](const std::string& text) { parsePair(text, options.spacingX, options.spacingZ); },
            "metres between texels, or EASTxSOUTH [1]")
        ->type_name("M")
        ->group(group);
    command.add_option("--vertical-scale", options.verticalScale, "metres a unit of height [1]")
        ->check(CLI::Range(1e-9, 1e9))
        ->type_name("S")
        ->group(group);
    command.add_flag("--terrain-rgb", options.terrainRgb, "heights are packed in R, G, B (Mapbox Terrain-RGB)")->group(group);
}

}  // namespace apertura
