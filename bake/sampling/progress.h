#pragma once
// How far work is, and whether it should go on.
#include <atomic>
#include <functional>
#include <mutex>

namespace apertura {

// Called now and then with the share done, 0..1; false stops the work. May be empty.
using Progress = std::function<bool(double)>;

// The work was stopped by its Progress.
struct Cancelled {};

// The part from..to of the whole; `progress` outlives it.
inline Progress part(const Progress& progress, double from, double to) {
    if (!progress) return {};
    return [&progress, from, to](double share) { return progress(from + (to - from) * share); };
}

// Progress of work that several threads share: reports from whichever thread comes by, one at a time, and
// stops everybody when told to.
class ProgressCounter {
public:
    ProgressCounter(const Progress& progress, size_t total) : progress_(progress), total_(total) {}
    void add(size_t n) {
        const size_t done = done_ += n;
        if (!progress_ || stopped_) return;
        if (std::unique_lock lock(mutex_, std::try_to_lock); lock)
            if (!progress_(double(done) / double(total_))) stopped_ = true;
    }
    bool stopped() const { return stopped_; }
    void throwIfStopped() const {
        if (stopped_) throw Cancelled{};
    }

private:
    const Progress& progress_;
    size_t total_;
    std::atomic<size_t> done_ = 0;
    std::atomic<bool> stopped_ = false;
    std::mutex mutex_;
};

}  // namespace apertura
