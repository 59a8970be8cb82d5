#pragma once
#include <cstring>
#include <functional>
#include <string>
#include <vector>

namespace apertura {

// Bytes between two processes.
class Parcel {
public:
    std::string bytes;

    template <typename T>
    void put(const T* values, size_t count) {
        bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
        if (count) bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
    }
    template <typename T>
    void put(const std::vector<T>& values) {
        put(values.data(), values.size());
    }
    template <typename T>
    std::vector<T> take() {
        size_t count = 0;
        std::memcpy(&count, &bytes.at(at_), sizeof count);
        at_ += sizeof count;
        std::vector<T> out(count);
        if (count) std::memcpy(static_cast<void*>(out.data()), &bytes.at(at_), count * sizeof(T));
        at_ += count * sizeof(T);
        return out;
    }

private:
    size_t at_ = 0;
};

// Runs `read` in a process of its own, silent on standard error, and returns what it filled in. The
// libraries that read foreign files crash and hang on damaged ones: here that is an Error that names
// `path`. The process gets `seconds` of processor time and 4 GiB on top of what is in use.
Parcel runIsolated(const std::string& path, int seconds, const std::function<void(Parcel&)>& read);

// A fair limit for a file of its size: `base` seconds and two for each MiB.
int secondsFor(const std::string& path, int base);

}  // namespace apertura
