#pragma once
// PNG in memory: the images that an asset holds. Colour spaces and gamma are left alone: samples are numbers.
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

namespace apertura {

// Four samples a pixel, row 0 on top.
struct RgbaImage {
    int width = 0, height = 0;
    int bits = 8;                   // of a sample in the file, 8 or 16
    std::vector<uint16_t> samples;  // 4 * width * height, 0 .. 2^bits - 1
};

// Throws std::bad_alloc.
std::vector<unsigned char> encodePng(const RgbaImage& image);

// Width and height, from its first bytes. Throws as decodePng does.
glm::ivec2 sizeOfPng(std::span<const unsigned char> bytes, const std::string& name);

constexpr int kLargestPng = 16384;  // pixels a side that decodePng reads

// Reads RGBA of 8 or 16 bits. Throws Error "NAME: ..." for anything else, and for what is damaged or too large.
RgbaImage decodePng(std::span<const unsigned char> bytes, const std::string& name);

}  // namespace apertura
