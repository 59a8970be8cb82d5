#pragma once
// Replays keys, mouse and waits from a text file: for tests and for pictures of the viewer.
#include <string>
#include <vector>

#include "tools/view/viewer.h"

namespace apertura {

// A line each; empty lines and those that begin with # say nothing.
//   key NAME                  as SDL names it, with ctrl+ or shift+ before
//   drag BUTTON X0 Y0 X1 Y1   left, middle or right; pixels
//   click X Y                 twice, which probes a point
//   wheel STEPS
//   model NAME                of the first picture
//   second NAME               of the second one
//   sun AZIMUTH ELEVATION     degrees
//   wait                      until the picture has settled
//   wait SECONDS
//   wait converged            until truth has
//   frames N                  draws N frames while the sun and lamps move, and prints how many pipelines, allocations
//                             and copies to the host they made
//   line                      prints the `apertura render` line of what is shown
//   save NAME                 .png or .exr, in the folder
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
    std::chrono::steady_clock::time_point since_;
};

}  // namespace apertura
