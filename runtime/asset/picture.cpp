#include "runtime/asset/picture.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cstdint>
#include <filesystem>
#include <glm/gtc/color_space.hpp>
#include <glm/gtc/packing.hpp>

#include "runtime/asset/error.h"
#include "runtime/asset/file.h"

namespace apertura {

namespace {

// Encodes in memory: the library does not report a disk that is full when it writes the last bytes.
void writeEncoded(const std::string& path, const OIIO::ImageSpec& spec, OIIO::TypeDesc type, const void* pixels) {
    PendingFile file(path);
    auto out = OIIO::ImageOutput::create(std::filesystem::path(path).extension().string().substr(1));
    if (!out) throw Error(path + ": cannot be written: " + OIIO::geterror());
    OIIO::Filesystem::IOVecOutput encoded;
    bool written = out->set_ioproxy(&encoded) && out->open(file.name(), spec) && out->write_image(type, pixels);
    written = out->close() && written;
    if (!written) throw Error(path + ": cannot be written: " + out->geterror());
    const auto& bytes = encoded.buffer();
    file.writeAll({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    file.commit();
}

}  // namespace

void writePicture(const std::string& path, const Picture& picture) {
    const std::string ending = std::filesystem::path(path).extension().string();
    const bool linear = ending == ".exr";
    if (!linear && ending != ".png") throw Error(path + ": pictures are .png or .exr");
    OIIO::ImageSpec spec(picture.width, picture.height, 3, linear ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", linear ? "Linear" : "sRGB");
    if (linear) return writeEncoded(path, spec, OIIO::TypeDesc::FLOAT, picture.pixels.data());
    std::vector<glm::u8vec3> bytes;
    bytes.reserve(picture.pixels.size());
    // 2.4 is the exact exponent; GLM's default for the curve is rounded to five digits.
    for (const glm::vec3& p : picture.pixels) bytes.push_back(glm::packUnorm<uint8_t>(glm::convertLinearToSRGB(p, 2.4f)));
    writeEncoded(path, spec, OIIO::TypeDesc::UINT8, bytes.data());
}

void writeHalves(const std::string& path, int width, int height, int channels, const std::vector<float>& values) {
    OIIO::ImageSpec spec(width, height, channels, OIIO::TypeDesc::HALF);
    spec.attribute("oiio:ColorSpace", "Linear");
    writeEncoded(path, spec, OIIO::TypeDesc::FLOAT, values.data());
}

}  // namespace apertura
