#pragma once
// How far some work is, and whether it should go on.
#include <atomic>
#include <functional>
#include <mutex>

namespace apertura {

// Called now and then with the fraction done, 0..1; returning false stops the work. May be empty.
using Progress = std::function<bool(double)>;

// Thrown where a Progress stopped the work.
struct Cancelled {};

// Reports the fraction done; throws Cancelled where the work is to stop.
inline void throwIfStopped(const Progress& progress, double done) {
    if (progress && !progress(done)) throw Cancelled{};
}

// The progress of a part of the work, from..to of the whole as fractions; `progress` must outlive it.
inline Progress part(const Progress& progress, double from, double to) {
    if (!progress) return {};
    return [&progress, from, to](double share) { return progress(from + (to - from) * share); };
}

// The progress of work that several threads do together: whichever thread comes by reports, one at a time, and a stop
// reaches all of them.
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
