#pragma once
// The visibility models: their names, what each stores, and what each makes of that when an asset is loaded.
// A model's number is in shaders/receiver.glsl, its formula in shaders/models.glsl and the files that it includes, its
// fit to rays in bake/fit/fit.cpp.
#include <array>
#include <span>
#include <string_view>

#include "apertura/sh/sh4.h"
#include "apertura/sh/shading.h"

namespace apertura {

// The parameters of one point, as a model's formula reads them. shaders/receiver.glsl says what each slot holds.
using ModelParams = std::array<vec4, APERTURA_MAX_SLOTS>;

// What a model stores, in the slots of its parameters from the first on. Each field is packed as numbers in -1..1.
enum class Field {
    None,      // ends the list
    Cap,       // an aperture; 3 numbers: x and y of the axis by octahedral mapping, and radius / pi
    Lobe,      // slope s and offset o; 4 numbers: x and y of the slope's axis, |s| / (|s| + 4), and the edge o / sqrt(1 + s^2 + o^2)
    HardLobe,  // a lobe with |s| = kHardSharpness or kSofterSharpness; 3 numbers: x and y of its axis, and 1/2 + rim / 2, where with x = o
               // / |s| the rim is .9 asin(sin(1.37) x) / 1.37 for |x| up to 1, and +-(.9 + .1 cbrt(|x| - 1)) up to 2
    Bend,      // an AperturaSoftQuadric's bend, in two slots; 5 numbers
    Heights4,  // sines of elevation at 4, 8, 16 or 32 azimuths (shaders/horizon.glsl), four to a slot; as many numbers
    Heights8,
    Heights16,
    Heights32,
    Faces,   // the faces of an ambient cube, in two slots; 6 numbers, 0..1
    Zonal,   // an SH coefficient of band 2; 1 number, over 0.8
    Bits32,  // 32 or 128 sectors as bits, 7 to a component; 5 or 19 numbers, each 7 bits over 127
    Bits128,
    Bands2,  // SH coefficients of band 2, in two slots; 5 numbers
    Bands4,  // SH coefficients of bands 2 to 4, in six slots; 21 numbers
};

// The third number of a cap or a lobe is never negative by itself; its sign is a flag. The first field's is set where a Combination
// has its complement or, in `anti`, where the cap is an anti-cap. With three and four hard lobes, the second field's is set where
// lobes 0 and 1 are a pair, and with four, the third's where lobes 2 and 3 are one too. The last hard lobe's is set where all of them have
// the softer edge.

// The lengths that the slope of hard lobes may have: from 10 to 90 % of the light, an edge is 2.5 or 10 degrees wide. The softer one
// is for silhouettes that are no planes: a hard edge that lies beside the true one is seen, and moves from point to point.
constexpr float kHardSharpness = 60, kSofterSharpness = 15;

// What a model is, as far as code beside its formula depends on it: how parameters are completed at load, which slot
// holds the flags of a Combination, and whether its integral over a light has a closed form.
enum class ModelKind {
    Formula,   // nothing beside its formula; one cap with a law of its own is this, and not Aperture
    Area,      // the visible area alone
    Aperture,  // one cap with a hard edge: the exact reference is the overlap of caps
    Anti,      // a cap, an anti-cap, or a blend
    CapAnti,   // the intersection of two caps, or its complement
    Union,     // the union of `parts` caps
    Lobes,     // the product of `parts` lobes, some of them in pairs, or its complement
    Quadric,   // one lobe with a quadratic exponent
    Choice,    // another model at each point
};

// One row of the table in sh/models.cpp. A row may leave out the fields that have defaults here.
struct Model {
    int id;                 // APERTURA_MODEL_..., the shader's specialisation constant
    std::string_view name;  // on the command line
    ModelKind kind = ModelKind::Formula;
    int parts = 1;  // caps or lobes
    int numbers;    // a point's numbers that the light's formula reads; of bits, eight to a number
    int slots = 0;  // vec4s of its parameters, 0..APERTURA_MAX_SLOTS
    // true: parameters may be interpolated, and the mix lies between its ends in every direction (a baseline's need not). false: the
    // light at the three corners of a triangle is interpolated. A model that mixes axes has a case in aperturaRenormalised.
    bool mixes = false;
    bool baseline = false;  // a rival, or a method as published: kept as it is where it fails
    // Makes the parameters from the four numbers; `normal` is unit. nullptr for models that must be stored.
    ModelParams (*fromVisibility)(const Visibility&, const vec3& normal) = nullptr;
    std::array<Field, 4> stored{};  // the fields of its parameters, if they are stored
    int autoTag = -1;               // its byte in an asset that `auto` chose for, never to change; -1: `auto` never chooses it
    int cycles = 0;            // where `auto` may choose it: what a light of 5 degrees costs above N.L on RDNA2, as Mesa 22.3 compiles it
    std::string_view what;     // description for people
    std::string_view alias{};  // another name that the command line and old files know it by
    // A rival's bytes a point as its authors pack it, without the four numbers, but with a byte for the sky's light where nothing else
    // gives that; 0: it has none of its own.
    int ownBytes = 0;

    bool isStored() const { return stored[0] != Field::None || kind == ModelKind::Choice; }
    // The slot of the lobes' Combination; -1 where there is none. For two caps it is the slot of AperturaTwoCaps' weight, which
    // stands where a Combination has its complement.
    int flagSlot() const {
        return kind == ModelKind::Lobes && parts > 1 ? parts : kind == ModelKind::Anti || kind == ModelKind::CapAnti ? 2 : -1;
    }
};

// All models: models()[id].id == id. Throws std::logic_error where a model has no formula.
std::span<const Model> models();

// True where aperturaIrradianceThrough has a formula for the model in this class of lights (APERTURA_LIGHTS_...) and, if `auto` may choose
// the model, for it as a choice.
bool hasFormula(const Model& model, int lightClass);

// The model of that name or alias, or nullptr.
const Model* findModel(std::string_view name);

// The models that `auto` may choose, in the order of their autoTag: 0, 1, ...
std::span<const Model* const> autoModels();

// The model that parameters are of: `model` itself or, for `auto`, the one that was chosen. Throws std::logic_error where parameters of
// `auto` hold no choice of one of autoModels().
const Model& chosenModel(const Model& model, const ModelParams& params);

// Writes the choice of `auto` into parameters. `outOfReach`: no model came within the tolerance.
void setChoice(ModelParams& params, const Model& chosen, bool outOfReach);

// How many numbers in -1..1 one point of the model stores beside its Visibility; 0 for models made from that. APERTURA_MODEL_AUTO
// has no size of its own: it stores the numbers of the chosen model.
int storedNumbers(const Model& model);

// Packs parameters into numbers in -1..1 and unpacks them; `numbers` has storedNumbers(model) elements. Defined for all
// values of either.
void packParams(const Model& model, const ModelParams& params, std::span<float> numbers);
ModelParams unpackParams(const Model& model, std::span<const float> numbers);

// Makes the numbers of an asset of 0.1, whose hard lobes have edges for rims, those of today.
void fromPacking1(const Model& model, std::span<float> numbers);

// What bytes (8 bits) or shorts (16) add at most to the apertures and lobes of a stored model, each number rounded by itself, radians; 0
// where it has none.
//   axis  the angle between axes: the octahedral mapping turns a step in x or y by at most 3 sqrt(2), at the middle of a face
//   edge  of the radius of an aperture; of the edge of a lobe where it passes at a right angle to the axis, nearer to which or farther
//         from which it moves more. Of `auto`, the largest of the models that it may choose
struct ParamsError {
    double axis = 0, edge = 0;
};
ParamsError paramsError(const Model& model, int bits);

// The parameters rotated from an instance's frame to the world or back; `rotation` is orthogonal.
ModelParams rotateParams(const Model& model, ModelParams params, const mat3& rotation);

// The parameters that the shader reads, about 8 million vertices a second on one core for `soft`.
//   stored  what unpackParams returned. The parameters are made from `visibility` instead where it is nullptr, or where
//           the model that APERTURA_MODEL_AUTO chose stores nothing
//   normal  any length; +Y is taken where it is zero or not finite
ModelParams toParams(const Model& model, const Visibility& visibility, const ModelParams* stored, const vec3& normal);

inline ModelParams paramsOf(const AperturaReceiver& receiver) { return std::to_array(receiver.params); }

inline AperturaReceiver toReceiver(const Visibility& v, const ModelParams& params, const vec3& normal) {
    AperturaReceiver receiver{normal, vec4(v.direction, v.area), {}};
    for (int i = 0; i < APERTURA_MAX_SLOTS; ++i) receiver.params[i] = params[i];
    return receiver;
}

// The receiver of a model that is made from the four numbers. `normal` is unit.
inline AperturaReceiver toReceiver(const Model& model, const Visibility& v, const vec3& normal) {
    return toReceiver(v, toParams(model, v, nullptr, normal), normal);
}

// E of a light, and of a sky, of unit radiance: W/m2 per W/m2/sr. The formulas that the shader runs, for the cheapest class that covers the
// light. `light`: aperturaCapLight of the direction towards it and the sine of its radius; lamps: aperturaCapOfSphere.
float evaluateLight(const Model& model, const AperturaReceiver& receiver, const AperturaCapLight& light);
float evaluateSky(const Model& model, const AperturaReceiver& receiver);

// The cheapest class of formulas, APERTURA_LIGHTS_..., that covers lights up to this radius, given as sin(radius): 0.6, 3 or 10
// degrees, or any.
inline int lightClassOf(float sinRadius) {
    return sinRadius <= 0.0105f ? APERTURA_LIGHTS_SUN
         : sinRadius <= 0.0524f ? APERTURA_LIGHTS_SMALL
         : sinRadius <= 0.1737f ? APERTURA_LIGHTS_MEDIUM
                                : APERTURA_LIGHTS_ANY;
}

}  // namespace apertura
