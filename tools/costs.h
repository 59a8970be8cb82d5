#pragma once
// What every model costs: cycles as Mesa's compilers state them for Radeons that need not be there, and time on this machine's device.
#include <map>
#include <span>
#include <string>
#include <vector>

#include "apertura/bake/sampling/progress.h"
#include "apertura/runtime/render/cost.h"

namespace apertura {

// Radeons to compile for with Mesa: one of RDNA2 and one of GCN4.
constexpr const char* kFamilies[] = {"navi21", "polaris10"};

// The key of a model in a class of lights. A shadow map has the id kShadowMapId.
using CostKey = std::pair<int, int>;
constexpr int kShadowMapId = -1;

// Cycles above those of the same shader with N.L alone.
struct Cycles {
    std::map<CostKey, int> light;  // one evaluation of the formula
    std::map<CostKey, int> pixel;  // a pixel: what it fetches, converts and evaluates, under one light and the sky
    std::map<CostKey, int> lit;    // a pixel of which the vertices were lit before
};

struct Costs {
    std::map<std::string, Cycles> cycles;  // by family; empty where Mesa's compiler is not there
    std::map<CostKey, double> time;        // of one evaluation, as a multiple of that of N.L
    std::map<CostKey, double> frame;       // of a whole frame, drawn the better way, a shadow map's depth pass included, likewise
    std::string device;                    // that the times are of; empty: there is none
};

// What Mesa's compiler states for a Radeon, of these models, of N.L and, for pixels, of a shadow map. Throws Error where the compiler is
// not there.
Cycles cyclesOn(const char* family, std::span<const Model* const> models, std::span<const int> lightClasses);

// Costs of the models, of N.L and of a shadow map, in these classes of lights (APERTURA_LIGHTS_...); frames in one class alone. What cannot
// be measured on this machine is left out, and said.
// Compiles in child processes: no other thread may be at work in this one. Throws Cancelled.
Costs measureCosts(std::span<const Model* const> models, std::span<const int> lightClasses, int frameClass, const Progress& progress = {});

}  // namespace apertura
