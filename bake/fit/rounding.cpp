#include "apertura/bake/fit/rounding.h"

#include <cmath>

#include "apertura/bake/fit/choose.h"
#include "apertura/bake/sampling/directions.h"

namespace apertura {
namespace {

constexpr int kDirections = 192;   // in which lobes are compared
constexpr float kSharpness = 10;   // of edges there, so that some directions see each, and lights are some degrees wide
constexpr float kFar = 1000;       // an offset that puts a lobe's edge out of sight
constexpr size_t kNumbers = 3;     // of a lobe or a cap
constexpr int kCombinations = 27;  // of three values of each
constexpr float kTop = 127;        // of a byte
constexpr float kLeast = 1e-6f;    // keeps the numbers of a lobe that no light passes near what they were

bool isEdge(Field field) { return field == Field::Cap || field == Field::HardLobe; }

// Slope and offset of a lobe; of a cap, those of the plane through its rim.
vec4 lobeOf(Field field, const vec4& slot) { return field == Field::Cap ? kHardSharpness * vec4(vec3(slot), slot.w - 1) : slot; }

// The slot of a lobe or a cap that lets all through, or nothing.
vec4 openOf(Field field, const vec4& slot) { return vec4(vec3(slot), field == Field::Cap ? 2 : kFar); }
vec4 closedOf(Field field, const vec4& slot) { return vec4(vec3(slot), field == Field::Cap ? 0 : -kFar); }

// The quadratic form in a change of slope and offset that says how much light changes, as far as the change is small.
//   params  of a point that looks up +Z, as the directions do
mat4 priceOfChanges(const Model& model, const ModelParams& params, size_t slot, std::span<const vec3> directions) {
    const Field field = model.stored[slot];
    ModelParams open = params, closed = params;
    open[slot] = openOf(field, params[slot]), closed[slot] = closedOf(field, params[slot]);
    const std::vector<float> most = visibleTo(directions, model, {{}, open}), least = visibleTo(directions, model, {{}, closed});
    const vec4 lobe = kSharpness / std::max(length(vec3(params[slot])), 1e-6f) * lobeOf(field, params[slot])
                    / (field == Field::Cap ? kHardSharpness : 1);
    mat4 out(kLeast);
    for (size_t i = 0; i < directions.size(); ++i) {
        const vec4 w(directions[i], 1);
        const float f = dot(lobe, w), change = directions[i].z * (most[i] - least[i]) * std::pow(1 + f * f, -1.5f);
        out += change * change * outerProduct(w, w);
    }
    return out;
}

}  // namespace

int roundedFarther(const Model& model, int bits) {
    return bits == 8 && (model.kind == ModelKind::Choice || isEdge(model.stored[0])) ? 3 : 1;
}

ModelParams roundedParams(const Model& model, const ModelParams& world, const vec3& normal, const mat3& toLocal, int bits) {
    const Model& own = chosenModel(model, world);
    if (bits != 8 || !isEdge(own.stored[0])) return world;
    static const std::vector<vec3> directions = fibonacciHemisphere(kDirections);
    const mat3 toAbove = transpose(frameFromZ(normal, 0)), toWorld = transpose(toLocal);
    const ModelParams above = rotateParams(own, world, toAbove);
    std::vector<float> numbers(size_t(storedNumbers(own)));
    packParams(own, rotateParams(own, world, toLocal), numbers);
    for (float& x : numbers) x = std::round(x * kTop);
    ModelParams out = world;
    for (size_t slot = 0; kNumbers * slot < numbers.size() && isEdge(own.stored[slot]); ++slot) {
        const Field field = own.stored[slot];
        const mat4 price = priceOfChanges(own, above, slot, directions);
        const vec4 wanted = lobeOf(field, above[slot]);
        double least = HUGE_VAL;
        for (int c = 0; c < kCombinations; ++c) {
            std::vector<float> tried = numbers;
            bool isPossible = true;
            for (size_t i = 0, rest = size_t(c); i < kNumbers; ++i, rest /= 3) {
                constexpr float beside[3] = {0, 1, -1};
                float& x = tried[kNumbers * slot + i];
                const bool flag = x < 0;
                x += beside[rest % 3];
                // The sign of the third number is a flag.
                isPossible = isPossible && std::abs(x) <= kTop && (i < 2 || (x < 0) == flag);
            }
            if (!isPossible) continue;
            for (float& x : tried) x /= kTop;
            const ModelParams params = rotateParams(own, unpackParams(own, tried), toWorld);
            const vec4 off = lobeOf(field, rotateParams(own, params, toAbove)[slot]) - wanted;
            if (const double sum = dot(off, price * off); sum < least) least = sum, out[slot] = params[slot];
        }
    }
    return out;
}

}  // namespace apertura
