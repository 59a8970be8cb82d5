#include "tools/terminal.h"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>

namespace apertura {
namespace {

constexpr std::chrono::seconds kLogged{15};  // between lines of a log

volatile std::sig_atomic_t stopAsked = 0;  // the only type that a signal handler may write

}  // namespace

void catchInterrupts() {
    struct sigaction action {};
    action.sa_handler = [](int) { stopAsked = 1; };
    action.sa_flags = SA_RESETHAND;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    sigaction(SIGHUP, &action, nullptr);
}

bool interrupted() { return stopAsked != 0; }

ProgressBar::ProgressBar(std::string label)
    : label_(std::move(label)), terminal_(isatty(STDERR_FILENO) != 0), start_(std::chrono::steady_clock::now()) {}

ProgressBar::~ProgressBar() {
    if (drawn_) std::fputs("\r\033[K", stderr);
}

Progress ProgressBar::callback() {
    return [this](double share) {
        if (terminal_)
            draw(share);
        else
            log(share);
        return !interrupted();
    };
}

void ProgressBar::draw(double share) {
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::milliseconds(100)) return;
    last_ = now;
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    const int width = 30, filled = int(std::clamp(share, 0.0, 1.0) * width);
    std::string bar(size_t(filled), '#');
    bar.resize(width, '.');
    std::fprintf(stderr, "\r%s [%s] %3.0f %%", label_.c_str(), bar.c_str(), 100 * share);
    if (share > 0.01 && elapsed > 0.5) std::fprintf(stderr, ", %.0f s left\033[K", elapsed * (1 - share) / share);
    std::fflush(stderr);
    drawn_ = true;
}

void ProgressBar::log(double share) {
    const auto now = std::chrono::steady_clock::now();
    if (now - std::max(last_, start_) < kLogged) return;
    last_ = now;
    std::fprintf(stderr, "%s: %.0f %% after %.0f s\n", label_.c_str(), 100 * share, std::chrono::duration<double>(now - start_).count());
}

}  // namespace apertura
