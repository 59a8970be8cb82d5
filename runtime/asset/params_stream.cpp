#include "apertura/runtime/asset/params_stream.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "apertura/runtime/asset/error.h"

namespace apertura {
namespace {

constexpr size_t kMostNumbers = 32;
constexpr std::byte kOutOfReach{0x80};

void putNumber(std::vector<std::byte>& out, float x, int bits) {
    const int top = (1 << (bits - 1)) - 1;
    const auto n = uint16_t(int16_t(std::lround(std::clamp(x, -1.0f, 1.0f) * float(top))));
    out.push_back(std::byte(n & 255));
    if (bits == 16) out.push_back(std::byte(n >> 8));
}

float takeNumber(std::span<const unsigned char>& in, int bits) {
    const float top = float((1 << (bits - 1)) - 1);
    const int n = bits == 16 ? int16_t(uint16_t(in[0] | in[1] << 8)) : int8_t(in[0]);
    in = in.subspan(size_t(bits / 8));
    return std::max(float(n) / top, -1.0f);
}

}  // namespace

std::vector<std::byte> packAllParams(const Model& model, std::span<const ModelParams> allParams, const mat3& toLocal, int bits) {
    std::vector<std::byte> out;
    const bool chosen = model.kind == ModelKind::Choice;
    if (chosen)
        for (const ModelParams& params : allParams)
            out.push_back(std::byte(chosenModel(model, params).autoTag)
                          | (aperturaChoiceIn(params[APERTURA_CHOICE_SLOT]).outOfReach ? kOutOfReach : std::byte(0)));
    float numbers[kMostNumbers];
    for (const ModelParams& params : allParams) {
        const Model& own = chosenModel(model, params);
        const size_t count = size_t(storedNumbers(own));
        packParams(own, rotateParams(own, params, toLocal), std::span(numbers, count));
        for (size_t i = 0; i < count; ++i) putNumber(out, numbers[i], bits);
    }
    return out;
}

std::vector<ModelParams> unpackAllParams(const Model& model, std::span<const unsigned char> bytes, size_t count, const mat3& toWorld,
                                         int bits, int packing) {
    std::span<const unsigned char> tags;
    const bool chosen = model.kind == ModelKind::Choice;
    if (chosen) {
        if (bytes.size() < count) throw Error("end too soon");
        tags = bytes.first(count);
        bytes = bytes.subspan(count);
    }
    std::vector<ModelParams> out(count);
    float numbers[kMostNumbers];
    for (size_t i = 0; i < count; ++i) {
        const size_t tag = chosen ? tags[i] & 0x7F : 0;
        if (chosen && tag >= autoModels().size()) throw Error("have a choice that is not a model");
        const Model& own = chosen ? *autoModels()[tag] : model;
        const size_t n = size_t(storedNumbers(own));
        if (bytes.size() < n * size_t(bits / 8)) throw Error("end too soon");
        for (size_t k = 0; k < n; ++k) numbers[k] = takeNumber(bytes, bits);
        if (packing == 1) fromPacking1(own, std::span(numbers, n));
        if (n) out[i] = rotateParams(own, unpackParams(own, std::span(numbers, n)), toWorld);
        if (chosen) setChoice(out[i], own, tags[i] & 0x80);
    }
    if (!bytes.empty()) throw Error("are more than vertices");
    return out;
}

}  // namespace apertura
