#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace apertura {

// One end of the pipe between two processes; values go through as bytes, a count before each run of them.
class PipeWriter {
public:
    explicit PipeWriter(int to) : to_(to) {}
    template <typename T>
    void put(const std::vector<T>& values) {
        const size_t count = values.size();
        write(&count, sizeof count);
        write(values.data(), count * sizeof(T));
    }

private:
    void write(const void* bytes, size_t size);
    int to_;
};

class PipeReader {
public:
    PipeReader(int from, double mostBytes) : from_(from), left_(mostBytes) {}
    template <typename T>
    std::vector<T> take() {
        std::vector<T> out(takeCount(sizeof(T)));
        read(out.data(), out.size() * sizeof(T));
        return out;
    }

private:
    size_t takeCount(size_t element);
    void read(void* bytes, size_t size);
    int from_;
    double left_;  // bytes that may still come
};

// What a process may take on top of what it begins with.
struct ResourceLimits {
    double seconds = 0;  // of processor time
    double bytes = 0;    // of memory, and of what it may send
};

// As much as reading a file of its size can need, and at most half of the machine's memory. `seconds`: for a small one.
ResourceLimits limitsFor(const std::string& path, double seconds);

// The libraries that read foreign files crash and hang on damaged ones: here that is an Error that names `path`.
// Runs `read` in a process of its own, silent on standard error, and `receive` on what it sends, in the same order.
void runIsolated(const std::string& path, const ResourceLimits& limits, const std::function<void(PipeWriter&)>& read,
                 const std::function<void(PipeReader&)>& receive);

}  // namespace apertura
