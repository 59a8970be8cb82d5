#pragma once
// A ground under a scene that has none, such as a scanned statue.
#include "apertura/runtime/asset/scene.h"

namespace apertura {

// The scene with a horizontal square beneath its lowest point, which it casts shadows on: kGroundSize times as wide as the scene's largest
// extent, in 48 columns and rows. Where the scene has no camera it gets the one that sees it without the ground (viewOf). A glTF document
// gets a node of its own for it. Throws Error naming the scene if that has no extent.
Scene withGround(Scene scene);
constexpr float kGroundSize = 4;

}  // namespace apertura
