#pragma once
#include <chrono>
#include <string>

#include "apertura/bake/sampling/tracer.h"

namespace apertura {

// After catchInterrupts the first Ctrl-C or SIGTERM sets the flag that interrupted() returns; a second one ends the program.
void catchInterrupts();
bool interrupted();

// A progress bar with the time left, on standard error if that is a terminal; otherwise silent. The destructor clears it.
// callback() returns a Progress that stops the work once interrupted() is true; the bar must outlive it.
class ProgressBar {
public:
    explicit ProgressBar(std::string label);
    ~ProgressBar();
    Progress callback();

private:
    void draw(double share);
    void log(double share);
    std::string label_;
    bool terminal_, drawn_ = false;
    std::chrono::steady_clock::time_point start_, last_{};
};

}  // namespace apertura
