#include "runtime/asset/picture.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>

#include "runtime/asset/error.h"
#include "runtime/asset/file.h"

namespace apertura {
namespace {

// IEC 61966-2-1.
uint8_t toSrgb(float linear) {
    const float c = std::clamp(linear, 0.0f, 1.0f);
    return uint8_t(std::lround(255 * (c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f)));
}

}  // namespace

Picture halved(const Picture& picture) {
    Picture out{picture.width / 2, picture.height / 2, {}};
    for (int y = 0; y < out.height; ++y)
        for (int x = 0; x < out.width; ++x) {
            const glm::vec3* p = &picture.pixels[size_t(2 * y) * picture.width + 2 * x];
            out.pixels.push_back(0.25f * (p[0] + p[1] + p[picture.width] + p[picture.width + 1]));
        }
    return out;
}

void writePicture(const std::string& path, const Picture& picture) {
    const std::string ending = std::filesystem::path(path).extension().string();
    const bool linear = ending == ".exr";
    if (!linear && ending != ".png") throw Error(path + ": pictures are .png or .exr");
    PendingFile file(path);
    auto out = OIIO::ImageOutput::create(ending.substr(1));
    if (!out) throw Error(path + ": cannot be written: " + OIIO::geterror());
    OIIO::ImageSpec spec(picture.width, picture.height, 3, linear ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", linear ? "Linear" : "sRGB");
    // Into memory first: the library does not say where a disk has no room for the last bytes.
    OIIO::Filesystem::IOVecOutput encoded;
    bool written = out->set_ioproxy(&encoded) && out->open(file.name(), spec);
    if (linear) {
        written = written && out->write_image(OIIO::TypeDesc::FLOAT, picture.pixels.data());
    } else {
        std::vector<uint8_t> bytes;
        for (const glm::vec3& p : picture.pixels)
            for (int c = 0; c < 3; ++c) bytes.push_back(toSrgb(p[c]));
        written = written && out->write_image(OIIO::TypeDesc::UINT8, bytes.data());
    }
    written = out->close() && written;
    if (!written) throw Error(path + ": cannot be written: " + out->geterror());
    const auto& bytes = encoded.buffer();
    file.writeAll({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    file.commit();
}

}  // namespace apertura
