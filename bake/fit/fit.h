#pragma once
// Turns the rays of one point into what each model stores of it.
#include <string_view>

#include "apertura/bake/fit/lobe_fit.h"
#include "apertura/sh/models.h"

namespace apertura {

// A baked point. Directions are in the samples' frame until makePoint rotates them to the world.
struct BakedPoint {
    Visibility visibility;
    ModelParams params{};  // of stored models only
};

// What fitting reuses from point to point: the lattice, and dictionaries over it.
struct FitTools {
    // What the tools are for; each takes more time to make than the one before: sampling only, fits of lobes and caps, or
    // choosing models as well.
    enum class Use { Samples, Fits, Choice };
    explicit FitTools(int rays, Use use = Use::Choice);
    SampleLattice lattice;
    CapDictionary dictionary;
    // The lights of one radius that a model is judged by.
    struct Probes {
        double radius;                         // radians
        std::vector<std::vector<int>> inside;  // for each light, the lattice's directions inside it
    };
    std::vector<Probes> probes;  // 5 and 15 degrees; empty unless made for Use::Choice
};

// What `auto` spends as little of as it can.
enum class Price {
    Numbers,  // that the light's formula reads
    Bytes,    // that a point stores beside the four numbers, at 8 bits a number
    Cycles,   // of a light of 5 degrees (Model::cycles)
};

struct FitOptions {
    double tolerance = 0.05;       // `auto` only: RMSE of E / (L pi sin^2 r)
    double lambda = 0;             // `auto` only: of the price, what a unit of squared error is worth; see lambdaFor in bake/fit/choose.h
    Price price = Price::Numbers;  // `auto` only
    bool terrain = false;          // horizons only: about the vertical, +Y, and not about the receiver's normal
};

// A way to make a model from rays: one line of `compare`, and one name for `bake --model`.
struct Recipe {
    std::string_view name;    // for bake --model
    std::string_view source;  // sh: coefficients of the visibility itself; rays: straight from the rays; fit: fitted
    int model;                // the model whose parameters it makes; -1: it makes the four numbers alone,
    int only;                 // for this model, or -1: for all that are made from them
    std::string_view what;
    // `frame` takes the samples' directions to the world; the result stays in the samples' frame.
    BakedPoint (*make)(const FitTools&, const Samples&, const mat3& frame, const FitOptions&);
};

// The four numbers of samples, by their SH coefficients, in the samples' frame.
Visibility project(const Samples& samples);

std::span<const Recipe> recipes();

// The recipe of that name, or nullptr.
const Recipe* findRecipe(std::string_view name);

// The recipe of that name; throws Error with the name where there is none.
const Recipe& recipeNamed(std::string_view name);

// The recipe that makes a model: "sh" for those that can be made from the four numbers, or else the one that makes its
// parameters. Throws Error where there is none.
const Recipe& recipeFor(const Model& model);

// How a model is made of lobes that are fitted, and back.
struct LobeForm {
    LobeFitSides sides;
    LobeFitOptions options;
    ModelParams (*toParams)(const LobeFit&);
    LobeFit (*toLobes)(const ModelParams&);  // LobeFit::error is not set
};

// That of a model, by its number; nullptr for models that are no lobes.
const LobeForm* lobeFormOf(int model);

// What tools a recipe needs.
FitTools::Use useOf(const Recipe& recipe);

// Makes one point and rotates it to the world by `frame`.
BakedPoint makePoint(const Recipe& recipe, const FitTools& tools, const Samples& samples, const mat3& frame, const FitOptions& options);

}  // namespace apertura
