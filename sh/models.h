#pragma once
#include <span>
#include <string_view>

#include "sh/shading.h"

namespace apertura {

// The visibility models that shade from the four numbers, in the order of their numbers in
// shaders/models.glsl.
struct ModelInfo {
    int id;                  // MODEL_..., the shader's specialisation constant
    std::string_view name;   // on the command line
    int numbers;             // of the four that it uses
    std::string_view what;   // for people
};
inline constexpr ModelInfo kModels[] = {
    {MODEL_AO, "ao", 1, "visible area alone"},
    {MODEL_SH_L1, "sh-l1", 4, "bands 0 and 1 of visibility, evaluated at the light"},
    {MODEL_OAT, "oat", 3, "aperture, formula as published in 2006"},
    {MODEL_APERTURE, "aperture", 3, "aperture, exact overlap of caps within 0.003"},
    {MODEL_SOFT, "soft", 4, "soft-edged aperture, uses all four numbers"},
};
static_assert(std::size(kModels) == MODEL_COUNT);

// nullptr where there is none of that name.
inline const ModelInfo* findModel(std::string_view name) {
    for (const ModelInfo& model : kModels)
        if (model.name == name) return &model;
    return nullptr;
}

}  // namespace apertura
