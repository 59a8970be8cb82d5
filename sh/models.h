#pragma once
// The visibility models: what each is called, what it stores, and what it makes of that at load. Its formula
// stands in shaders/models.glsl, or what that includes, its number in shaders/receiver.glsl; how it is fitted to rays in bake/fit/fit.cpp.
#include <algorithm>
#include <array>
#include <span>
#include <string_view>

#include "sh/sh4.h"
#include "sh/shading.h"

namespace apertura {

// One point in the form that a model's formula reads.
using ModelParams = std::array<vec4, MAX_SLOTS>;

// What stands in a slot of the parameters, and how it travels: as that many numbers of -1..1.
enum class Field {
    Cap,       // axis, height: 3 numbers, the axis octahedral and the radius / pi
    Lobe,      // slope, offset: 4, the slope's axis, its length and the edge
    HardLobe,  // the same with a length of kHardSharpness: 3
    Bend,      // 5, of a slot and the next: SoftQuadric's
    Heights,   // 16 sines of elevation, in four slots
    Bands2,    // 5 SH coefficients of band 2, in two slots
    Bands4,    // 21 of the bands 2 to 4, in six slots
};

// Sharpness of the lobes that store none.
constexpr float kHardSharpness = 60;

struct Model {
    int id;                  // MODEL_..., the shader's specialisation constant
    std::string_view name;   // on the command line
    int numbers;             // a point, that the light's formula reads
    int slots;               // of its parameters
    bool mixes;              // parameters may be interpolated; otherwise the light of three corners is
    bool baseline;           // a rival, or as published: kept as it is where it fails
    std::string_view what;   // for people
    // The parameters, from the four numbers; nothing where the model is stored instead.
    ModelParams (*fromVisibility)(const Visibility&, const vec3& normal);
    std::array<Field, 4> stored;  // the first slots in turn, where the model is stored
    int storedFields;
    int combineSlot;         // whose x is the flag of an inverse product, and of lobes w the pairs (see combineLobes); -1:
                             // none. They travel as signs
};

// All of them, models()[id].id == id.
std::span<const Model> models();

// nullptr where there is none of that name.
const Model* findModel(std::string_view name);

// The model that stored parameters are of: `model` itself, or the choice of MODEL_AUTO, which stands in [4].y.
inline int chosenModel(int model, const ModelParams& params) {
    if (model != MODEL_AUTO) return model;
    return std::clamp(int(params[4].y + 0.5f), 0, MODEL_COUNT - 1);
}

// Numbers in -1..1 that one point of the model stores beside its Visibility; 0 for those made from it.
// MODEL_AUTO has no size of its own: it stores the chosen model's.
int storedNumbers(const Model& model);

// Parameters as numbers of -1..1 and back; `numbers` has storedNumbers(model) elements. Total over all values.
void packParams(const Model& model, const ModelParams& params, std::span<float> numbers);
ModelParams unpackParams(const Model& model, std::span<const float> numbers);

// The parameters turned by `rotation` (orthogonal): from an instance's frame to the world or back.
ModelParams rotateParams(const Model& model, ModelParams params, const mat3& rotation);

// The parameters that the shader reads: as they were stored, or made from the four numbers where `stored` is null or
// the choice of MODEL_AUTO stores nothing. `normal` of any length; of none it is +Y.
ModelParams toParams(const Model& model, const Visibility& visibility, const ModelParams* stored, const vec3& normal);

inline Receiver toReceiver(const Visibility& v, const ModelParams& params, const vec3& normal) {
    Receiver receiver{normal, vec4(v.direction, v.area), {}};
    for (int i = 0; i < MAX_SLOTS; ++i) receiver.params[i] = params[i];
    return receiver;
}

// The receiver of a model that is made from the four numbers.
inline Receiver toReceiver(const Model& model, const Visibility& v, const vec3& normal) {
    return toReceiver(v, toParams(model, v, nullptr, normal), normal);
}

// The formulas to use for lights up to this radius, as sin(radius): LIGHTS_...
inline int lightClassOf(float sinRadius) {
    return sinRadius <= 0.0105f ? LIGHTS_SUN : sinRadius <= 0.0524f ? LIGHTS_SMALL : sinRadius <= 0.1737f ? LIGHTS_MEDIUM : LIGHTS_ANY;
}

}  // namespace apertura
