// Textures from their files: decoded in a process apart, and filtered to mips.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/color_space.hpp>
#include <map>

#include "apertura/runtime/asset/gltf_document.h"
#include "apertura/runtime/asset/isolated.h"
#include "apertura/runtime/asset/materials.h"

namespace apertura {
namespace {

constexpr int kLargest = 16384;  // texels a side

// OpenImageIO's name for the format, from the first bytes; null for others.
const char* formatOf(std::span<const unsigned char> bytes) {
    const std::string_view head(reinterpret_cast<const char*>(bytes.data()), std::min<size_t>(bytes.size(), 12));
    if (head.starts_with("\x89PNG")) return "png";
    if (head.starts_with("\xFF\xD8\xFF")) return "jpeg";
    if (head.starts_with("RIFF") && head.ends_with("WEBP")) return "webp";
    return nullptr;
}

// Four channels of an image, and its size first; nothing if it cannot be read.
std::vector<uint8_t> decoded(std::span<const unsigned char> bytes, int& width, int& height) {
    const char* const format = formatOf(bytes);
    if (!format) return {};
    const auto in = OIIO::ImageInput::create(format);
    if (!in || !in->supports("ioproxy")) return {};
    OIIO::Filesystem::IOMemReader source(const_cast<unsigned char*>(bytes.data()), bytes.size());
    OIIO::ImageSpec spec, hints;
    hints.attribute("oiio:UnassociatedAlpha", 1);
    in->set_ioproxy(&source);
    if (!in->open("image", spec, hints)) return {};
    in->threads(1);  // a forked process has none of the pool that its parent may have started
    if (spec.width <= 0 || spec.height <= 0 || std::max(spec.width, spec.height) > kLargest || spec.nchannels < 1) return {};
    const int channels = std::min(spec.nchannels, 4);
    const size_t count = size_t(spec.width) * size_t(spec.height);
    std::vector<uint8_t> values(count * size_t(channels)), out(4 * count, 255);
    if (!in->read_image(0, 0, 0, channels, OIIO::TypeDesc::UINT8, values.data())) return {};
    const bool grey = channels < 3;
    for (size_t i = 0; i < count; ++i) {
        const uint8_t* const from = &values[i * size_t(channels)];
        for (size_t c = 0; c < 3; ++c) out[4 * i + c] = from[grey ? 0 : c];
        if (channels == 2 || channels == 4) out[4 * i + 3] = from[channels - 1];
    }
    width = spec.width, height = spec.height;
    return out;
}

uint8_t encoded(float linear) {
    static const std::vector<uint8_t> table = [] {
        std::vector<uint8_t> out;
        for (int i = 0; i <= 8192; ++i) out.push_back(uint8_t(std::lround(255 * glm::convertLinearToSRGB(glm::dvec1(i / 8192.0), 2.4).x)));
        return out;
    }();
    return table[size_t(std::lround(std::clamp(linear, 0.0f, 1.0f) * 8192))];
}

const std::array<float, 256>& linearTable() {
    static const std::array<float, 256> table = [] {
        std::array<float, 256> out{};
        for (size_t i = 0; i < out.size(); ++i) out[i] = glm::convertSRGBToLinear(glm::dvec1(double(i) / 255)).x;
        return out;
    }();
    return table;
}

glm::vec4 linearOf(const glm::u8vec4& texel) {
    const std::array<float, 256>& linear = linearTable();
    return {linear[texel.r], linear[texel.g], linear[texel.b], float(texel.a) / 255};
}

int wrapped(int x, int size, Texture::Wrap wrap) {
    if (wrap == Texture::Wrap::Clamp) return std::clamp(x, 0, size - 1);
    const int period = wrap == Texture::Wrap::Mirror ? 2 * size : size, within = (x % period + period) % period;
    return within < size ? within : period - 1 - within;
}

glm::vec4 inMip(const Texture& texture, const Texture::Mip& mip, const glm::vec2& place) {
    const auto texel = [&](int x, int y) {
        return linearOf(
            mip.texels[size_t(wrapped(y, mip.height, texture.wrapV)) * size_t(mip.width) + size_t(wrapped(x, mip.width, texture.wrapU))]);
    };
    // Ints do not overflow then; so far away floats step by whole texels.
    const glm::vec2 near = glm::clamp(place, -1e4f, 1e4f) * glm::vec2(mip.width, mip.height);
    if (texture.nearest) return texel(int(std::floor(near.x)), int(std::floor(near.y)));
    const glm::vec2 first = glm::floor(near - 0.5f), part = near - 0.5f - first;
    const int x = int(first.x), y = int(first.y);
    return glm::mix(glm::mix(texel(x, y), texel(x + 1, y), part.x), glm::mix(texel(x, y + 1), texel(x + 1, y + 1), part.x), part.y);
}

// The mean of linear values. Where a texel is transparent its colour does not count.
Texture::Mip halved(const Texture::Mip& from) {
    Texture::Mip out{std::max(from.width / 2, 1), std::max(from.height / 2, 1), {}};
    out.texels.reserve(size_t(out.width) * size_t(out.height));
    for (int y = 0; y < out.height; ++y)
        for (int x = 0; x < out.width; ++x) {
            glm::vec3 sum(0), plain(0);
            float alpha = 0;
            for (int k = 0; k < 4; ++k) {
                const int fx = std::min(2 * x + (k & 1), from.width - 1), fy = std::min(2 * y + (k >> 1), from.height - 1);
                const glm::u8vec4& t = from.texels[size_t(fy) * size_t(from.width) + size_t(fx)];
                const glm::vec3 colour(linearOf(t));
                sum += float(t.a) * colour, plain += colour, alpha += float(t.a);
            }
            const glm::vec3 mean = alpha > 0 ? sum / alpha : 0.25f * plain;
            out.texels.emplace_back(encoded(mean.r), encoded(mean.g), encoded(mean.b), uint8_t(std::lround(alpha / 4)));
        }
    return out;
}

std::vector<Texture::Mip> mipsOf(Texture::Mip first) {
    std::vector<Texture::Mip> out;
    out.push_back(std::move(first));
    while (out.back().width > 1 || out.back().height > 1) out.push_back(halved(out.back()));
    return out;
}

// The image of a texture, or -1.
int imageOf(const Json& json, size_t texture) {
    const Json& own = json["textures"][texture];
    const size_t count = listOf(json, "images").size();
    const auto index = [&](const Json& from) {
        return from.is_object() && from.contains("source") && from["source"].is_number_unsigned() && from["source"].get<size_t>() < count
                 ? int(from["source"].get<size_t>())
                 : -1;
    };
    if (const int plain = index(own); plain >= 0 || !own.is_object()) return plain;
    const Json extensions = own.value("extensions", Json::object());
    return extensions.is_object() && extensions.contains("EXT_texture_webp") ? index(extensions["EXT_texture_webp"]) : -1;
}

}  // namespace

glm::vec4 Texture::at(const glm::vec2& place, float level) const {
    if (!mips || !std::isfinite(place.x) || !std::isfinite(place.y)) return glm::vec4(1);
    const std::vector<Mip>& all = *mips;
    const float within = std::clamp(level, 0.0f, float(all.size() - 1));
    const auto lower = size_t(within);
    const glm::vec4 first = inMip(*this, all[lower], place);
    return lower + 1 < all.size() ? glm::mix(first, inMip(*this, all[lower + 1], place), within - float(lower)) : first;
}

void loadTextures(Scene& scene, TexturesFor use) {
    if (!scene.document) return;
    const GltfDocument& document = *scene.document;
    std::map<int, std::vector<size_t>> wanted;  // textures of each image
    std::vector<bool> isWanted(scene.textures.size());
    for (const Material& material : scene.materials) {
        if (material.baseTexture >= 0 && (use == TexturesFor::Pictures || material.alpha != Material::Alpha::Opaque))
            isWanted[size_t(material.baseTexture)] = true;
        if (material.emissiveTexture >= 0 && use == TexturesFor::Pictures) isWanted[size_t(material.emissiveTexture)] = true;
    }
    size_t lost = 0;
    for (size_t t = 0; t < isWanted.size(); ++t)
        if (isWanted[t] && !scene.textures[t]->mips && !scene.textures[t]->isLost) {
            if (const int image = imageOf(document.json, t); image >= 0)
                wanted[image].push_back(t);
            else
                ++lost, scene.textures[t]->isLost = true;
        }
    const auto bytesOf = [&](int image) -> std::span<const unsigned char> {
        const Json& json = document.json["images"][size_t(image)];
        if (json.contains("bufferView")) return viewBytes(document, json["bufferView"].get<size_t>());
        return {document.images[size_t(image)]->data(), document.images[size_t(image)]->size()};
    };
    const auto read = [&](PipeWriter& pipe) {
        for (const auto& [image, textures] : wanted) {
            int width = 0, height = 0;
            std::vector<uint8_t> texels;
            try {
                texels = decoded(bytesOf(image), width, height);
            } catch (const std::bad_alloc&) {
                width = height = 0;
            }
            pipe.put(std::vector<int>{width, height});
            pipe.put(texels);
        }
    };
    double memory = 0;
    const auto receive = [&](PipeReader& pipe) {
        for (const auto& [image, textures] : wanted) {
            const std::vector<int> size = pipe.take<int>();
            const std::vector<uint8_t> texels = pipe.take<uint8_t>();
            if (size.size() != 2 || size[0] <= 0 || texels.size() != 4 * size_t(size[0]) * size_t(size[1])) {
                lost += textures.size();
                for (const size_t t : textures) scene.textures[t]->isLost = true;
                continue;
            }
            memory += double(texels.size()) * 4 / 3;
            requireMemory(scene.name, "its textures", memory);
            Texture::Mip first{size[0], size[1], std::vector<glm::u8vec4>(texels.size() / 4)};
            std::copy(texels.begin(), texels.end(), &first.texels[0].r);
            const auto mips = std::make_shared<const std::vector<Texture::Mip>>(mipsOf(std::move(first)));
            for (const size_t t : textures) scene.textures[t]->mips = mips;
        }
    };
    if (!wanted.empty()) {
        // Of an image: ten seconds, and what the largest takes twice.
        const double images = double(wanted.size());
        const ResourceLimits limits{60 + 10 * images, 0x1p32 + std::min(64.0 * double(document.fileBytes) + 0x1p26 * images, 0x1p36)};
        runIsolated(scene.name, limits, read, receive);
    }
    if (lost > 0)
        scene.notes.push_back(std::to_string(lost) + (lost == 1 ? " texture is" : " textures are")
                              + " missing, damaged or of an unknown kind, and white here");
}

}  // namespace apertura
