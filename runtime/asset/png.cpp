#include "runtime/asset/png.h"

#include <spng.h>

#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>

#include "runtime/asset/error.h"
#include "runtime/asset/scene.h"

namespace apertura {
namespace {

constexpr size_t kLargestChunk = size_t(1) << 24;  // bytes of what stands beside the pixels

using Context = std::unique_ptr<spng_ctx, decltype(&spng_ctx_free)>;
Context makeContext(int flags) {
    Context out(spng_ctx_new(flags), spng_ctx_free);
    if (!out) throw std::bad_alloc();
    return out;
}

size_t samplesOf(const RgbaImage& image) { return 4 * size_t(image.width) * size_t(image.height); }

}  // namespace

std::vector<unsigned char> encodePng(const RgbaImage& image) {
    const Context context = makeContext(SPNG_CTX_ENCODER);
    spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1);
    spng_ihdr header{uint32_t(image.width), uint32_t(image.height), uint8_t(image.bits), SPNG_COLOR_TYPE_TRUECOLOR_ALPHA, 0, 0, 0};
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

RgbaImage decodePng(std::span<const unsigned char> bytes, const std::string& name) {
    const Context context = makeContext(0);
    const auto check = [&](int status) {
        if (status != 0) throw Error(name + ": cannot be read as PNG: " + spng_strerror(status));
    };
    check(spng_set_image_limits(context.get(), kLargestPng, kLargestPng));
    check(spng_set_chunk_limits(context.get(), kLargestChunk, kLargestChunk));
    check(spng_set_png_buffer(context.get(), bytes.data(), bytes.size()));
    spng_ihdr header{};
    check(spng_get_ihdr(context.get(), &header));
    if (header.color_type != SPNG_COLOR_TYPE_TRUECOLOR_ALPHA || (header.bit_depth != 8 && header.bit_depth != 16))
        throw Error(name + ": is no PNG of four channels of 8 or 16 bits");
    RgbaImage out{int(header.width), int(header.height), header.bit_depth, {}};
    // Deflate makes at most 1032 bytes of one.
    if (double(samplesOf(out)) * out.bits / 8 > 1032.0 * double(bytes.size()))
        throw Error(name + ": is damaged: it has fewer bytes than pixels need");
    requireMemory(name, "its pixels", double(samplesOf(out)) * 8);
    if (out.bits == 16) {
        out.samples.resize(samplesOf(out));
        check(spng_decode_image(context.get(), out.samples.data(), samplesOf(out) * 2, SPNG_FMT_PNG, 0));
    } else {
        std::vector<uint8_t> narrow(samplesOf(out));
        check(spng_decode_image(context.get(), narrow.data(), narrow.size(), SPNG_FMT_PNG, 0));
        out.samples.assign(narrow.begin(), narrow.end());
    }
    check(spng_decode_chunks(context.get()));  // up to the end, which may be missing
    return out;
}

}  // namespace apertura
