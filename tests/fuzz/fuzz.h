#pragma once
// What the fuzz targets share.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

namespace apertura::fuzz {

// A folder in memory for one process's files.
inline const std::filesystem::path& scratch() {
    static const std::filesystem::path folder = [] {
        std::string pattern = "/dev/shm/apertura-fuzz-XXXXXX";
        if (!mkdtemp(pattern.data())) std::abort();
        std::atexit([] {
            std::error_code ignored;
            std::filesystem::remove_all(scratch(), ignored);
        });
        return std::filesystem::path(pattern);
    }();
    return folder;
}

// The input, with the length that a .glb states for itself set right: else few would get past it.
inline std::vector<unsigned char> withLength(const uint8_t* data, size_t size) {
    std::vector<unsigned char> out(data, data + size);
    const auto length = uint32_t(size);
    if (size >= 12 && std::memcmp(data, "glTF", 4) == 0) std::memcpy(&out[8], &length, 4);
    return out;
}

}  // namespace apertura::fuzz
