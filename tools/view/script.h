#pragma once
// Replays keys, mouse and waits from a text file: for tests and for pictures of the viewer.
#include <string>
#include <vector>

#include "tools/view/viewer.h"

namespace apertura {

// A line each; empty lines and those that begin with # say nothing.
inline constexpr const char* kScriptCommands =
    "key NAME                 as SDL names it, with ctrl+ or shift+ before\n"
    "drag BUTTON X0 Y0 X1 Y1  left, middle or right; pixels\n"
    "click X Y                twice, which probes a point\n"
    "wheel STEPS\n"
    "model NAME               of the first picture\n"
    "second NAME              of the second one, or reference\n"
    "sun AZIMUTH ELEVATION    degrees\n"
    "wait [SECONDS]           or until the picture has settled\n"
    "wait converged           until truth has\n"
    "frames N                 N frames while the sun and lamps move; prints how many pipelines, allocations and copies they made\n"
    "clock                    prints the seconds since the last such line, or since the program read the script\n"
    "line                     prints the `apertura render` line of what is shown\n"
    "save NAME                .png or .exr, in the folder of --save\n";

class Script {
public:
    // Throws Error "FILE:LINE: cause" for a line that is none of these.
    Script(const std::string& path, std::string folder);

    // Does what is due before the next frame; false at the end. Throws Error, also where a wait takes longer than ten minutes.
    bool step(Viewer& viewer);

private:
    struct Line {
        int number;
        std::vector<std::string> words;
    };
    bool isOver(Viewer& viewer, const Line& line);
    [[noreturn]] void fail(const Line& line, const std::string& cause) const;

    std::string path_, folder_;
    std::vector<Line> lines_;
    size_t next_ = 0;
    bool begun_ = false;
    int frames_ = 0;
    GpuCounters before_;
    std::chrono::steady_clock::time_point since_, clock_ = std::chrono::steady_clock::now();
};

}  // namespace apertura
