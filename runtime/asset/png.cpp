#include "apertura/runtime/asset/png.h"

#include <spng.h>

#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>

#include "apertura/runtime/asset/error.h"

namespace apertura {
namespace {

constexpr size_t kLargestChunk = size_t(1) << 24;  // bytes of what stands beside the pixels

using Context = std::unique_ptr<spng_ctx, decltype(&spng_ctx_free)>;
Context makeContext(int flags) {
    Context out(spng_ctx_new(flags), spng_ctx_free);
    if (!out) throw std::bad_alloc();
    return out;
}

void check(int status, const std::string& name) {
    if (status != 0) throw Error(name + ": cannot be read as PNG: " + spng_strerror(status));
}

size_t samplesOf(const PngImage& image) { return size_t(image.channels) * size_t(image.width) * size_t(image.height); }

}  // namespace

std::vector<unsigned char> encodePng(const PngImage& image) {
    const Context context = makeContext(SPNG_CTX_ENCODER);
    spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1);
    const auto colours = image.channels == 1 ? SPNG_COLOR_TYPE_GRAYSCALE
                       : image.channels == 3 ? SPNG_COLOR_TYPE_TRUECOLOR
                                             : SPNG_COLOR_TYPE_TRUECOLOR_ALPHA;
    spng_ihdr header{uint32_t(image.width), uint32_t(image.height), uint8_t(image.bits), uint8_t(colours), 0, 0, 0};
    spng_set_ihdr(context.get(), &header);
    int status;
    if (image.bits == 16) {
        status = spng_encode_image(context.get(), image.samples.data(), samplesOf(image) * 2, SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE);
    } else {
        const std::vector<uint8_t> narrow(image.samples.begin(), image.samples.end());
        status = spng_encode_image(context.get(), narrow.data(), narrow.size(), SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE);
    }
    size_t length = 0;
    int failed = 0;
    const std::unique_ptr<void, decltype(&std::free)> bytes(spng_get_png_buffer(context.get(), &length, &failed), std::free);
    if (status != 0 || !bytes) throw std::bad_alloc();
    const auto* begin = static_cast<const unsigned char*>(bytes.get());
    return {begin, begin + length};
}

namespace {

// 0: of a kind that decodePng does not read.
int channelsOf(const spng_ihdr& header) {
    return header.color_type == SPNG_COLOR_TYPE_GRAYSCALE       ? 1
         : header.color_type == SPNG_COLOR_TYPE_TRUECOLOR       ? 3
         : header.color_type == SPNG_COLOR_TYPE_TRUECOLOR_ALPHA ? 4
                                                                : 0;
}

// Throws Error unless it is a PNG that decodePng reads.
spng_ihdr headerOf(spng_ctx* context, std::span<const unsigned char> bytes, const std::string& name) {
    check(spng_set_image_limits(context, kLargestPng, kLargestPng), name);
    check(spng_set_chunk_limits(context, kLargestChunk, kLargestChunk), name);
    check(spng_set_png_buffer(context, bytes.data(), bytes.size()), name);
    spng_ihdr header{};
    check(spng_get_ihdr(context, &header), name);
    if (channelsOf(header) == 0 || (header.bit_depth != 8 && header.bit_depth != 16))
        throw Error(name + ": is no PNG of one, three or four channels of 8 or 16 bits");
    // Deflate makes at most 1032 bytes of one.
    if (double(header.width) * header.height * channelsOf(header) * header.bit_depth / 8 > 1032.0 * double(bytes.size()))
        throw Error(name + ": is damaged: it has fewer bytes than its pixels need");
    return header;
}

}  // namespace

glm::ivec2 sizeOfPng(std::span<const unsigned char> bytes, const std::string& name) {
    const spng_ihdr header = headerOf(makeContext(0).get(), bytes, name);
    return {header.width, header.height};
}

PngImage decodePng(std::span<const unsigned char> bytes, const std::string& name) {
    const Context context = makeContext(0);
    const spng_ihdr header = headerOf(context.get(), bytes, name);
    PngImage out{int(header.width), int(header.height), header.bit_depth, {}, channelsOf(header)};
    if (out.bits == 16) {
        out.samples.resize(samplesOf(out));
        check(spng_decode_image(context.get(), out.samples.data(), samplesOf(out) * 2, SPNG_FMT_PNG, 0), name);
    } else {
        std::vector<uint8_t> narrow(samplesOf(out));
        check(spng_decode_image(context.get(), narrow.data(), narrow.size(), SPNG_FMT_PNG, 0), name);
        out.samples.assign(narrow.begin(), narrow.end());
    }
    check(spng_decode_chunks(context.get()), name);  // up to the end, which may be missing
    return out;
}

}  // namespace apertura
