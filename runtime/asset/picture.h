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
inline Picture halved(const Picture& picture) {
    Picture out{picture.width / 2, picture.height / 2, {}};
    for (int y = 0; y < out.height; ++y)
        for (int x = 0; x < out.width; ++x) {
            const glm::vec3* p = &picture.pixels[size_t(2 * y) * picture.width + 2 * x];
            out.pixels.push_back(0.25f * (p[0] + p[1] + p[picture.width] + p[picture.width + 1]));
        }
    return out;
}

// Writes .png (8 bits, sRGB curve, clamped to 0..1) or .exr (linear, half floats, 65504 at most), whole or not at all. Throws Error
// naming `path` if it has another ending or cannot be written.
void writePicture(const std::string& path, const Picture& picture);

// The bytes of an .exr of half floats: 1 channel as Y, 3 as R, G, B, 4 as R, G, B, A. `values`: channels * width * height, row by row from
// the top. Throws Error.
std::vector<unsigned char> encodeHalves(int width, int height, int channels, const std::vector<float>& values);

}  // namespace apertura
