#pragma once
// From the rays of one point to what each model stores of it.
#include <string_view>

#include "bake/fit/lobe_fit.h"
#include "sh/models.h"

namespace apertura {

// A point as a model has it; directions in the frame of the samples, until they are turned.
struct BakedPoint {
    Visibility visibility;
    ModelParams params{};  // of stored models
};

// What fitting keeps from point to point: the lattice, and dictionaries over it.
struct FitTools {
    // What of it is needed costs time to make: Samples alone, fits of lobes and caps, or choosing models as well.
    enum class Use { Samples, Fits, Choice };
    explicit FitTools(int rays, Use use = Use::Choice);
    SampleLattice lattice;
    CapDictionary dictionary;
    // Lights that judge a model: of each, the samples inside it.
    struct Probes {
        double radius;                         // radians
        std::vector<std::vector<int>> inside;  // directions of the lattice
    };
    std::vector<Probes> probes;  // of 5 and of 15 degrees
};

struct FitOptions {
    double tolerance = 0.05;  // of `auto`: RMSE of E / (L pi sin^2 r)
    double lambda = 0;        // of `auto`: stored numbers that a unit of squared error is worth; see bake/fit/choose.h
};

// A way to make a model from rays: one line of `compare`, and one name for `bake --model`.
struct Recipe {
    std::string_view name;    // of bake --model
    std::string_view source;  // sh: coefficients of the visibility itself; rays: straight from the rays; fit
    int model;                // that it is stored for, or -1 for those that are made from the four numbers:
    int only;                 // for this one alone, or -1 for all of them
    std::string_view what;
    // `frame` takes the samples' directions to the world; the result is in the samples' frame.
    BakedPoint (*make)(const FitTools&, const Samples&, const mat3& frame, const FitOptions&);
};

std::span<const Recipe> recipes();

// nullptr where there is none of that name.
const Recipe* findRecipe(std::string_view name);

// The same, where it must be there: throws Error naming it.
const Recipe& recipeNamed(std::string_view name);

// What makes a model: the recipe that stores it, or else the visibility's own four numbers. Throws Error where there is neither.
const Recipe& recipeFor(const Model& model);

// What of its tools a recipe needs.
FitTools::Use useOf(const Recipe& recipe);

// Makes the point and turns it to the world.
BakedPoint makePoint(const Recipe& recipe, const FitTools& tools, const Samples& samples, const mat3& frame, const FitOptions& options);

}  // namespace apertura
