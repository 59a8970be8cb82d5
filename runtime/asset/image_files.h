#pragma once
// The images of an asset as files beside it, for programs that take no glTF.
#include <string>
#include <vector>

#include "runtime/asset/asset.h"

namespace apertura {

enum class ImageFormat { Png, Exr };  // the same as in the asset, or the numbers themselves in half floats

// Their names: ASSET without .glb, then .visibility, or .bent-normal and .occlusion, before the number of the instance where there is more
// than one.
std::vector<std::string> imageFiles(const std::string& asset, size_t instances, bool bentNormals, ImageFormat format);

// Writes all images of a bake, each whole or not at all. In .exr, visibility is D / pi and A / pi - 1 in R, G, B, A; bent normals are
// (1 + n) / 2. `bits`: of a sample of a .png. Throws Error naming the file that cannot be written.
void writeImages(const std::string& asset, const Scene& scene, const BakedVisibility& visibility, int bits, ImageFormat format);

}  // namespace apertura
