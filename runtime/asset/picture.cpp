#include "apertura/runtime/asset/picture.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cstdint>
#include <filesystem>
#include <glm/gtc/color_space.hpp>
#include <glm/gtc/packing.hpp>

#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/file.h"

namespace apertura {

namespace {

// `name`: of the file, whose ending decides, for errors too. In memory: the library does not report a disk that is full when it writes the
// last bytes.
std::vector<unsigned char> encode(const std::string& name, const OIIO::ImageSpec& spec, OIIO::TypeDesc type, const void* pixels) {
    auto out = OIIO::ImageOutput::create(std::filesystem::path(name).extension().string().substr(1));
    if (!out) throw Error(name + ": cannot be written: " + OIIO::geterror());
    OIIO::Filesystem::IOVecOutput encoded;
    bool written = out->set_ioproxy(&encoded) && out->open(name, spec) && out->write_image(type, pixels);
    written = out->close() && written;
    if (!written) throw Error(name + ": cannot be written: " + out->geterror());
    return encoded.buffer();
}

}  // namespace

void writePicture(const std::string& path, const Picture& picture) {
    const std::string ending = std::filesystem::path(path).extension().string();
    const bool linear = ending == ".exr";
    if (!linear && ending != ".png") throw Error(path + ": pictures are .png or .exr");
    OIIO::ImageSpec spec(picture.width, picture.height, 3, linear ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", linear ? "Linear" : "sRGB");
    PendingFile file(path);
    std::vector<unsigned char> encoded;
    if (linear) {
        constexpr float kMost = 65504;  // the largest half: the sun itself is brighter
        std::vector<glm::vec3> pixels = picture.pixels;
        for (glm::vec3& p : pixels) p = glm::min(p, kMost);
        encoded = encode(path, spec, OIIO::TypeDesc::FLOAT, pixels.data());
    } else {
        std::vector<glm::u8vec3> pixels;
        pixels.reserve(picture.pixels.size());
        // 2.4 is the exact exponent; GLM's default for the curve is rounded to five digits.
        for (const glm::vec3& p : picture.pixels) pixels.push_back(glm::packUnorm<uint8_t>(glm::convertLinearToSRGB(p, 2.4f)));
        encoded = encode(path, spec, OIIO::TypeDesc::UINT8, pixels.data());
    }
    file.writeAll({reinterpret_cast<const char*>(encoded.data()), encoded.size()});
    file.commit();
}

std::vector<unsigned char> encodeHalves(int width, int height, int channels, const std::vector<float>& values) {
    OIIO::ImageSpec spec(width, height, channels, OIIO::TypeDesc::HALF);
    spec.attribute("oiio:ColorSpace", "Linear");
    return encode("image.exr", spec, OIIO::TypeDesc::FLOAT, values.data());
}

}  // namespace apertura
