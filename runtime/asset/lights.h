#pragma once
// Lights from files.
#include <string>
#include <vector>

#include "apertura/runtime/asset/scene.h"
#include "apertura/sh/shading.h"

namespace apertura {

// Reads a JSON list of at most 16 lights, each {"towards": [x, y, z], "radius": degrees} or {"at": [x, y, z], "radius": metres}, with
// "radiance": [r, g, b] in W/m2/sr. Throws Error naming the file and the light.
std::vector<AperturaLight> readLights(const std::string& path);

// The lights of the scene's glTF file (KHR_lights_punctual), with a size: a directional one has the radius `angle`, radians, and others are
// glowing spheres of `radius` metres that give off the same. 683 lm are taken for 1 W. `notes` gets a line for spot lights, which shine
// in all directions here. Throws Error naming the scene if it has none, too many or a broken one.
std::vector<AperturaLight> punctualLights(const Scene& scene, double radius, double angle, std::vector<std::string>& notes);

}  // namespace apertura
