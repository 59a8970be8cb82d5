#pragma once
// The visibility models: what each is called, what it stores, and what it makes of that at load. Its formula
// stands in shaders/models.glsl, or what that includes, its number in shaders/receiver.glsl; how it is fitted to rays in bake/fit/fit.cpp.
#include <array>
#include <span>
#include <string_view>

#include "sh/sh4.h"
#include "sh/shading.h"

namespace apertura {

// One point in the form that a model's formula reads.
using ModelParams = std::array<vec4, MAX_SLOTS>;

// What a model stores, in the slots of its parameters from the first on, and how that travels: as so many numbers of -1..1.
enum class Field {
    None,      // the end of the list
    Cap,       // an aperture. 3 numbers: the axis, octahedral, and the radius / pi
    Lobe,      // slope and offset. 4: the slope's axis, its length, and the edge
    HardLobe,  // the same of sharpness kHardSharpness. 3: axis and edge
    Bend,      // SoftQuadric's bend, in two slots. 5
    Heights,   // sines of elevation at 16 azimuths, in four slots. 16
    Bands2,    // SH coefficients of band 2, in two slots. 5
    Bands4,    // of the bands 2 to 4, in six slots. 21
};

// Sharpness of the lobes that store none.
constexpr float kHardSharpness = 60;

// What a model means, as far as more than its formula depends on it: how parameters are completed when they are loaded, where the
// flags of a combination stand, and whether its integral over a light has a closed form.
enum class ModelKind {
    Formula,   // nothing but its formula
    Area,      // the visible area alone
    Aperture,  // one cap
    Anti,      // a cap, an anti-cap, or a blend
    CapAnti,   // what two caps let through together, or its complement
    Union,     // what any of `parts` caps lets through
    Lobes,     // the product of `parts` lobes, its complement, or pairs
    Quadric,   // one lobe with a quadratic exponent
    Choice,    // another model for each point
};

// One row of the table in sh/models.cpp. A field that a row leaves out is as here.
struct Model {
    int id;                 // MODEL_..., the shader's specialisation constant
    std::string_view name;  // on the command line
    ModelKind kind = ModelKind::Formula;
    int parts = 1;          // caps or lobes
    int numbers;            // a point, that the light's formula reads
    int slots = 0;          // of its parameters
    bool mixes = false;     // parameters may be interpolated; otherwise the light of three corners is
    bool baseline = false;  // a rival, or as published: kept as it is where it fails
    // The parameters, from the four numbers; nothing where the model is stored instead.
    ModelParams (*fromVisibility)(const Visibility&, const vec3& normal) = nullptr;
    std::array<Field, 4> stored{};  // what is stored, where it is
    int autoTag = -1;               // its byte in an asset that `auto` chose for, for ever the same; -1: never chosen
    std::string_view what;          // for people

    bool isStored() const { return stored[0] != Field::None || kind == ModelKind::Choice; }
    // Slot of the lobes' Combination, whose complement is where TwoCaps has its weight; -1 where there is none.
    int flagSlot() const { return kind == ModelKind::Lobes ? parts : kind == ModelKind::Anti || kind == ModelKind::CapAnti ? 2 : -1; }
};

// All of them, models()[id].id == id. Throws std::logic_error where one has no formula.
std::span<const Model> models();

// Whether irradianceThrough knows the model and, where `auto` may choose it, knows it as a choice too.
bool hasFormula(const Model& model, int lightClass);

// nullptr where there is none of that name.
const Model* findModel(std::string_view name);

// Those that `auto` may choose, by their autoTag: 0, 1, ...
std::span<const Model* const> autoModels();

// The model that parameters are of: `model` itself, or what MODEL_AUTO chose. The choice is one of autoModels().
const Model& chosenModel(const Model& model, const ModelParams& params);
void setChoice(ModelParams& params, const Model& chosen, bool outOfReach);

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

inline ModelParams paramsOf(const Receiver& receiver) { return std::to_array(receiver.params); }

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
