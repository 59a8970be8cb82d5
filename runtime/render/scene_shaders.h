#pragma once
// The shaders that draw a scene with a model: which text for which case.
#include <array>
#include <span>

#include "apertura/runtime/render/draw.h"
#include "apertura/sh/models.h"
#include "lit.frag.h"
#include "lit.vert.h"
#include "scene0.vert.h"
#include "scene00.frag.h"
#include "scene01.frag.h"
#include "scene1.vert.h"
#include "scene10.frag.h"
#include "scene11.frag.h"
#include "scene30.frag.h"
#include "scene31.frag.h"
#include "scene40.frag.h"
#include "scene41.frag.h"

namespace apertura {

// How scene.frag is compiled: see its head.
enum class Corners { Mixed, One, Three, Interpolated };

inline std::span<const uint32_t> sceneFragment(Corners corners, bool oneLight) {
    switch (corners) {
        case Corners::Mixed: return oneLight ? std::span<const uint32_t>(scene01_frag) : scene00_frag;
        case Corners::One: return oneLight ? std::span<const uint32_t>(scene11_frag) : scene10_frag;
        case Corners::Interpolated: return oneLight ? std::span<const uint32_t>(scene41_frag) : scene40_frag;
        default: return oneLight ? std::span<const uint32_t>(scene31_frag) : scene30_frag;
    }
}
inline std::span<const uint32_t> sceneVertex(Corners corners) {
    return corners == Corners::Interpolated ? std::span<const uint32_t>(scene1_vert) : scene0_vert;
}

// For a model, in a scene with samples beside its vertices or without.
inline Corners cornersFor(const Model& model, bool moreSamples) {
    if (!model.mixes) return Corners::Three;
    return !moreSamples && model.slots <= 1 ? Corners::Interpolated : Corners::Mixed;
}

}  // namespace apertura
