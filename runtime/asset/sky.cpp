#include "apertura/runtime/asset/sky.h"

#include <OpenImageIO/imageio.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "apertura/runtime/asset/error.h"
#include "apertura/runtime/asset/file.h"
#include "apertura/runtime/asset/isolated.h"

namespace apertura {
namespace {

using std::numbers::pi;

constexpr float kBrightest = 1e12f;  // W/m2/sr: 50 000 times the sun
constexpr int64_t kMostPixels = int64_t(1) << 26;
constexpr double kMostPixelsAByte = 4096;  // four times what deflate reaches on zeros

// Direction of the middle of a pixel.
glm::dvec3 directionAt(const Picture& p, int x, int y) {
    const double azimuth = 2 * pi * ((x + 0.5) / p.width - 0.5), elevation = pi * (0.5 - (y + 0.5) / p.height);
    return {std::cos(elevation) * std::sin(azimuth), std::sin(elevation), -std::cos(elevation) * std::cos(azimuth)};
}

// The bands of sky.glsl: sums over the sphere of the radiance times 1, w and w w' - 1/3, with the factors (2 l + 1) / 4 pi of the Legendre
// polynomials P_l(w . w'), and 3/2 for the highest term of P_2.
AperturaSky bandsOf(const Picture& p) {
    std::array<glm::dvec3, 9> sum{};
    for (int y = 0; y < p.height; ++y) {
        const double top = pi * (0.5 - double(y) / p.height), bottom = pi * (0.5 - double(y + 1) / p.height);
        const double solidAngle = 2 * pi / p.width * (std::sin(top) - std::sin(bottom));
        for (int x = 0; x < p.width; ++x) {
            const glm::dvec3 w = directionAt(p, x, y), l = solidAngle * glm::dvec3(p.pixels[size_t(y) * p.width + x]);
            const std::array<double, 9> of{1, w.x, w.y, w.z, w.x * w.x - 1.0 / 3, w.z * w.z - 1.0 / 3, w.x * w.y, w.y * w.z, w.z * w.x};
            for (size_t k = 0; k < of.size(); ++k) sum[k] += of[k] * l;
        }
    }
    AperturaSky out{};
    for (size_t k = 0; k < sum.size(); ++k) {
        const double factor = k == 0 ? 1 : k < 4 ? 3 : k < 6 ? 7.5 : 15;
        out.bands[k] = vec4(factor / (4 * pi) * sum[k], 0);
    }
    return out;
}

std::string formatOf(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    std::string head(6, '\0');
    in.read(head.data(), 6);
    if (head.starts_with("\x76\x2F\x31\x01")) return "openexr";
    if (head.starts_with("#?RADI") || head.starts_with("#?RGBE")) return "hdr";
    throw Error("a sky is an .exr or .hdr picture");
}

// Sends the width and height, and the pixels.
void read(const std::string& path, PipeWriter& pipe) {
    const auto in = OIIO::ImageInput::create(formatOf(path));
    OIIO::ImageSpec spec;
    if (!in || !in->open(path, spec)) throw Error("cannot be read as an image");
    in->threads(1);  // a forked process has none of the pool that its parent may have started
    const int64_t count = int64_t(spec.width) * spec.height;
    if (count <= 0 || count > kMostPixels || double(count) > kMostPixelsAByte * double(std::filesystem::file_size(path)))
        throw Error("has " + std::to_string(spec.width) + " x " + std::to_string(spec.height) + " pixels, more than can be read");
    if (spec.nchannels != 1 && spec.nchannels < 3) throw Error("has no channels R, G and B");
    const int channels = std::min(spec.nchannels, 3);
    std::vector<float> values(size_t(count) * size_t(channels));
    if (!in->read_image(0, 0, 0, channels, OIIO::TypeDesc::FLOAT, values.data())) throw Error("cannot be read as an image: damaged");
    std::vector<glm::vec3> pixels(static_cast<size_t>(count));
    for (size_t i = 0; i < pixels.size(); ++i)
        for (int c = 0; c < 3; ++c) pixels[i][c] = values[i * size_t(channels) + size_t(std::min(c, channels - 1))];
    pipe.put(std::vector<int>{spec.width, spec.height});
    pipe.put(pixels);
}

}  // namespace

Sky::Sky(const glm::vec3& radiance) { bands_.bands[0] = vec4(radiance, 0); }

Sky::Sky(Picture picture, const std::string& name) {
    if (picture.width <= 0 || picture.width != 2 * picture.height)
        throw Error(name + ": a sky is twice as wide as high, and this has " + std::to_string(picture.width) + " x "
                    + std::to_string(picture.height) + " pixels");
    for (const glm::vec3& p : picture.pixels)
        for (int c = 0; c < 3; ++c)
            if (!(p[c] >= 0 && p[c] <= kBrightest)) throw Error(name + ": a pixel's radiance is not a finite number of 0 to 1e12 W/m2/sr");
    bands_ = bandsOf(picture);
    picture_ = std::make_shared<const Picture>(std::move(picture));
}

glm::vec3 Sky::towards(const glm::vec3& direction) const {
    if (!picture_) return vec3(bands_.bands[0]);
    const Picture& p = *picture_;
    const vec2 at = aperturaPlaceInSky(direction) * vec2(p.width, p.height) - 0.5f, first = floor(at), part = at - first;
    const auto pixel = [&](int x, int y) {
        return p.pixels[size_t(std::clamp(y, 0, p.height - 1)) * p.width + size_t((x % p.width + p.width) % p.width)];
    };
    const int x = int(first.x), y = int(first.y);
    return mix(mix(pixel(x, y), pixel(x + 1, y), part.x), mix(pixel(x, y + 1), pixel(x + 1, y + 1), part.x), part.y);
}

glm::vec3 Sky::meanOver(const AperturaCapLight& cap) const {
    if (!picture_) return vec3(bands_.bands[0]);
    // Cells of equal solid angle.
    constexpr int kRings = 12, kSectors = 24;
    const vec3 right = aperturaTangentTo(cap.axis), up = cross(cap.axis, right);
    glm::dvec3 sum(0);
    for (int ring = 0; ring < kRings; ++ring) {
        const double height = double(cap.height) * (ring + 0.5) / kRings, cosine = 1 - height,
                     sine = std::sqrt(std::max(height * (2 - height), 0.0));
        for (int k = 0; k < kSectors; ++k) {
            const double turn = 2 * pi * (k + 0.5 * (ring & 1)) / kSectors;
            sum += towards(float(cosine) * cap.axis + float(sine * std::cos(turn)) * right + float(sine * std::sin(turn)) * up);
        }
    }
    return sum / double(kRings * kSectors);
}

Sky readSky(const std::string& path) {
    requireOrdinaryFile(path);
    Picture picture;
    runIsolated(
        path, limitsFor(path, 5), [&](PipeWriter& pipe) { read(path, pipe); },
        [&](PipeReader& pipe) {
            const std::vector<int> size = pipe.take<int>();
            picture.pixels = pipe.take<glm::vec3>();
            if (size.size() != 2 || picture.pixels.size() != size_t(size[0]) * size_t(size[1])) throw Error(path + ": damaged");
            picture.width = size[0];
            picture.height = size[1];
        });
    return {std::move(picture), path};
}

}  // namespace apertura
