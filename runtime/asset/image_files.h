#pragma once
// The images of an asset as files beside it, for programs that take no glTF.
#include <memory>
#include <string>
#include <vector>

#include "apertura/runtime/asset/asset.h"
#include "apertura/runtime/asset/file.h"

namespace apertura {

constexpr size_t kMostImageFiles = 256;

enum class ImageFormat { Png, Exr };  // the same as in the asset, or the numbers themselves in half floats

// Their names: ASSET without .glb, then .visibility, or .bent-normal and .occlusion, before a number where there is more than one instance:
// that of its entry in asset.extras.apertura.
std::vector<std::string> imageFiles(const std::string& asset, size_t instances, bool bentNormals, ImageFormat format);

// Encodes all images of a bake under temporary names; commit() each. In .exr, visibility is D / pi and A / pi - 1 in R, G, B, A, a bent
// normal x, y, z in R, G, B, each -1..1, and occlusion Y. `bits`: of a sample of a .png. Throws Error naming the file that cannot be
// written.
std::vector<std::unique_ptr<PendingFile>> pendingImages(const std::string& asset, const Scene& scene, const BakedVisibility& visibility,
                                                        int bits, ImageFormat format);

}  // namespace apertura
