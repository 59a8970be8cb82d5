#pragma once
// Bent normals and occlusion, as engines read them: how an asset holds the two images.
#include <set>
#include <string>

#include "apertura/runtime/asset/asset.h"
#include "apertura/runtime/asset/gltf_writer.h"
#include "apertura/runtime/asset/png.h"

namespace apertura {

// The two images of an instance, as an asset holds them: x, y and z in red, green and blue, (1 + number) / 2 each; and grey.
PngImage bentImage(const BentNormals& bent, int bits);
PngImage occlusionImage(const BentNormals& bent, int bits);

// The images of a scene in a document: adds them to it and returns their description, or null where no instance has one. Every
// primitive that has them gets a material of its own, a
// copy of the file's, whose occlusionTexture is the second; no material of glTF has a place for the first.
Json addBentNormals(GltfWriter& writer, const Scene& scene, const BakedVisibility& visibility, int bits);

// Takes out what an earlier bake added: images, tangents and the copies of materials, which give way to the file's own; one that a program
// has changed since stays, without our image. Adds the accessors and views that are not used any more.
void removeBentNormals(Json& json, std::set<size_t>& accessors, std::set<size_t>& views);

// How many instances have both images, of those that `described`, asset.extras.apertura, names.
int countBentNormals(const Json& json, const Json& described);

}  // namespace apertura
