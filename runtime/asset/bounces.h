#pragma once
// What surfaces reflect to vertices and samples (AperturaBounce), in the asset: attributes of each primitive, and two accessors for the
// samples on faces, found by their names, in the order of _VISIBILITY_SAMPLES.
//   _BOUNCE, _BOUNCE_SAMPLES                  VEC3 UNSIGNED_BYTE, normalised: the square roots of the shares
//   _BOUNCE_TOWARDS, _BOUNCE_TOWARDS_SAMPLES  VEC3 BYTE, normalised: `towards`, in the frame of the primitive's vertices
#include <optional>

#include "apertura/runtime/asset/asset.h"
#include "apertura/runtime/asset/gltf_writer.h"
#include "apertura/runtime/asset/view.h"

namespace apertura {

// Adds the attributes to an instance's primitive.
void addBounces(GltfWriter& writer, Json& primitive, const std::vector<AperturaBounce>& bounces, const glm::mat3& rotation);
// Adds the accessors of all samples on faces; nothing where there are none.
void addBouncesOnFaces(GltfWriter& writer, const Scene& scene, const BakedVisibility& seen);

// Takes all of that away; returns the accessors' indices, for GltfWriter::release.
std::set<size_t> removeBounces(Json& json);

// Reads what an asset has whose vertices and faces have been read. Where a part of it is missing or does not fit, it adds a line to the
// scene's notes and leaves all of it out. Throws Error naming the scene if an accessor cannot be read.
void readBounces(Asset& asset);

bool hasBounces(const Asset& asset);

// The one albedo that all surfaces had when they were baked; nothing if they had their materials' colours, or nothing is stored.
std::optional<glm::vec3> bakedAlbedo(const BakeInfo& info);

// Where a view of the asset takes from what surfaces reflect: APERTURA_BOUNCES_...
int bounceSourceOf(const View& view, const Asset& asset);
// Bytes that it takes in the file.
size_t bytesOfBounces(const Asset& asset);

}  // namespace apertura
