#pragma once
#include <chrono>
#include <string>

#include "bake/sampling/tracer.h"

namespace apertura {

// From now on the first Ctrl-C or SIGTERM sets a flag; a second one ends the program at once.
void catchInterrupts();
bool interrupted();

// A bar with the time left, on standard error, where that is a terminal; otherwise silent. Cleared when it
// goes out of scope. As a Progress it returns false once the user has asked to stop.
class ProgressBar {
public:
    explicit ProgressBar(std::string label);
    ~ProgressBar();
    Progress callback();

private:
    void draw(double share);
    std::string label_;
    bool terminal_, drawn_ = false;
    std::chrono::steady_clock::time_point start_, last_{};
};

}  // namespace apertura
