#pragma once
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace apertura {

// Linear RGB radiance, row by row from the top.
struct Picture {
    int width = 0, height = 0;
    std::vector<glm::vec3> pixels;
};

// The picture at half the width and height: each pixel is the mean of four. Both sides must be even.
Picture halved(const Picture& picture);

// Writes .png (8 bits, sRGB curve, clamped to 0..1) or .exr (linear, half floats), whole or not at all. Throws Error
// naming `path` if it has another ending or cannot be written.
void writePicture(const std::string& path, const Picture& picture);

}  // namespace apertura
