#pragma once
// The procedural scenes.
#include "apertura/bake/scene/load.h"

namespace apertura {

// A built-in scene and where the models are measured in it.
struct BuiltinScene {
    Scene scene;
    std::vector<bool> receives;      // one per surface: does it have receivers
    std::vector<Box> receiverBoxes;  // world, metres: receivers lie in any of these; empty: everywhere
    bool skyAboveGround = true;      // lights lie above the horizontal; false: above each receiver
};
// Generates the scene of the name "builtin:NAME"; nullopt if there is none.
std::optional<BuiltinScene> findBuiltin(const std::string& name);

// The names of the ten procedural scenes of the charts. Their seeds are fixed: they are the same bytes everywhere.
const std::vector<std::string>& builtinNames();

// builtin:arcade; the others are in builtin.cpp.
void makeArcade(BuiltinScene& out);

}  // namespace apertura
