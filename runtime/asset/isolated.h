#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace apertura {

// The writing end of a pipe between two processes. T must be trivially copyable: each vector goes through as its length
// and its bytes.
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

// The reading end. It takes vectors in the order and of the types that the writer put. `mostBytes`: the most that may
// come in all; a vector that claims more is refused before memory is asked for.
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

// Limits of a process, on top of what it uses when it starts.
struct ResourceLimits {
    double seconds = 0;  // of processor time
    double bytes = 0;    // of memory, and the most that it may send
};

// Limits for reading a file, by its size: `seconds` and 2 more per MiB; 1 GiB and 64 bytes per byte of the file, but at
// most half of the machine's memory.
ResourceLimits limitsFor(const std::string& path, double seconds);

// Work in a child process. The libraries that read foreign files crash and hang on damaged ones: here that becomes an Error "PATH: cause",
// like an Error of the work and the end of a limit. The child's standard error is silenced.
class IsolatedWork {
public:
    // Starts it. No other thread may be at work in this process: a child that is made while one holds a lock waits for it for ever.
    IsolatedWork(std::string path, const ResourceLimits& limits, const std::function<void(PipeWriter&)>& work);
    ~IsolatedWork();  // ends it
    IsolatedWork(const IsolatedWork&) = delete;

    // Calls `receive` on what the work sends, and waits for its end. Call it once.
    void finish(const std::function<void(PipeReader&)>& receive);

private:
    std::string path_;
    double mostBytes_;
    int child_ = -1, from_ = -1;
};

// Runs `read` in a child process and `receive`, in this one, on what `read` sends, as IsolatedWork does.
void runIsolated(const std::string& path, const ResourceLimits& limits, const std::function<void(PipeWriter&)>& read,
                 const std::function<void(PipeReader&)>& receive);

}  // namespace apertura
