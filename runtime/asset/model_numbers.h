#pragma once
// What a stored model adds at vertices, beside _VISIBILITY.
//   a model of fixed size   attributes _VISIBILITY_NUMBERS_0, _1, ... of each primitive, four numbers each and the last one what is left,
//                           normalised bytes or shorts as _VISIBILITY: whatever a tool does with vertices, it does with these
//   auto                    an accessor that is found by its name, _VISIBILITY_CHOICES: SCALAR UNSIGNED_BYTE, the bytes of params_stream.h,
//                           instance after instance. asset.extras.apertura.choices says what they belong to: "vertices", hashOfPoints in
//                           the order of vertices; "bytes", a hash of what the accessor holds; "numbers", the bytes of each instance
// Assets of version 0.1 have a buffer view of such bytes for each primitive, which asset.extras.apertura.forms names.
#include "apertura/runtime/asset/asset.h"
#include "apertura/runtime/asset/gltf_writer.h"

namespace apertura {

// Adds the attributes of an instance's primitive; nothing where the model is auto.
void addNumbers(GltfWriter& writer, Json& primitive, const Model& stored, const SeenByInstance& seen, const glm::mat3& rotation, int bits);

// Adds what auto has chosen at the vertices of all instances. Returns the description; null of other models.
Json addChoices(GltfWriter& writer, const Scene& scene, const BakedVisibility& seen, const Model* stored, int bits);

// Takes all of it out of the JSON, and returns the indices of what it leaves, for GltfWriter::release.
struct ReleasedNumbers {
    std::set<size_t> accessors, views;
};
ReleasedNumbers removeNumbers(Json& json);

// Reads `asset.seen[i].allParams`. Where they are gone or belong to other vertices it adds a line to the scene's notes, forgets the
// samples' numbers, too, and the asset stores nothing but the four numbers: `asset.info.model` is then "sh".
//   atVertices  of each instance, what its vertices store, -1..1
void readNumbers(Asset& asset, const Json& described, std::span<const std::vector<glm::vec4>> atVertices);

// What the numbers of points take in the file, bytes. `asAttributes`: of vertices, of which a model of fixed size pads an attribute to a
// multiple of four.
size_t bytesOfNumbers(const Model* stored, const std::vector<ModelParams>& allParams, int bits, bool asAttributes);

}  // namespace apertura
