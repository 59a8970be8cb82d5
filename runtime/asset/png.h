#pragma once
// PNG in memory: the images that an asset holds. Colour spaces and gamma are left alone: samples are numbers.
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

namespace apertura {

// Row 0 on top.
struct PngImage {
    int width = 0, height = 0;
    int bits = 8;                   // of a sample in the file, 8 or 16
    std::vector<uint16_t> samples;  // channels * width * height, 0 .. 2^bits - 1
    int channels = 4;               // of a pixel: 1, grey; 3, RGB; or 4, RGBA
};

// Throws std::bad_alloc.
std::vector<unsigned char> encodePng(const PngImage& image);

// Width and height, from its first bytes. Throws as decodePng does.
glm::ivec2 sizeOfPng(std::span<const unsigned char> bytes, const std::string& name);

constexpr int kLargestPng = 16384;  // pixels a side that decodePng reads

// Reads grey, RGB or RGBA of 8 or 16 bits. Throws Error "NAME: ..." for anything else, and for what is damaged or too large.
PngImage decodePng(std::span<const unsigned char> bytes, const std::string& name);

}  // namespace apertura
