#include "runtime/asset/params_stream.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/asset/error.h"

namespace apertura {
namespace {

constexpr int kChoices[] = {MODEL_AO, MODEL_APERTURE, MODEL_SOFT, MODEL_FIRM_2, MODEL_SOFT_2, MODEL_FIRM_3, MODEL_SOFT_L2, MODEL_FIRM_4};
constexpr size_t kMostNumbers = 32;
constexpr std::byte kUnreached{0x80};

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

std::span<const int> autoChoices() { return kChoices; }

std::vector<std::byte> packAllParams(const Model& model, std::span<const ModelParams> allParams, const mat3& toLocal, int bits) {
    std::vector<std::byte> out;
    if (model.id == MODEL_AUTO)
        for (const ModelParams& params : allParams)
            out.push_back(std::byte(std::find(std::begin(kChoices), std::end(kChoices), chosenModel(MODEL_AUTO, params)) - std::begin(kChoices))
                          | (params[4].z > 0.5f ? kUnreached : std::byte(0)));
    float numbers[kMostNumbers];
    for (const ModelParams& params : allParams) {
        const Model& own = models()[size_t(chosenModel(model.id, params))];
        const size_t count = size_t(storedNumbers(own));
        packParams(own, rotateParams(own, params, toLocal), std::span(numbers, count));
        for (size_t i = 0; i < count; ++i) putNumber(out, numbers[i], bits);
    }
    return out;
}

std::vector<ModelParams> unpackAllParams(const Model& model, std::span<const unsigned char> bytes, size_t count, const mat3& toWorld, int bits) {
    std::span<const unsigned char> tags;
    if (model.id == MODEL_AUTO) {
        if (bytes.size() < count) throw Error("the models' choices end too soon");
        tags = bytes.first(count);
        bytes = bytes.subspan(count);
    }
    std::vector<ModelParams> out(count);
    float numbers[kMostNumbers];
    for (size_t i = 0; i < count; ++i) {
        int id = model.id;
        if (model.id == MODEL_AUTO) {
            const size_t choice = tags[i] & 0x7F;
            if (choice >= std::size(kChoices)) throw Error("a vertex's choice is not a model");
            id = kChoices[choice];
        }
        const Model& own = models()[size_t(id)];
        const size_t n = size_t(storedNumbers(own));
        if (bytes.size() < n * size_t(bits / 8)) throw Error("the models' numbers end too soon");
        for (size_t k = 0; k < n; ++k) numbers[k] = takeNumber(bytes, bits);
        if (n) out[i] = rotateParams(own, unpackParams(own, std::span(numbers, n)), toWorld);
        if (model.id == MODEL_AUTO) out[i][4].y = float(id), out[i][4].z = tags[i] & 0x80 ? 1 : 0;
    }
    if (!bytes.empty()) throw Error("there are more of the models' numbers than vertices");
    return out;
}

}  // namespace apertura
