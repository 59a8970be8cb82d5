#pragma once
// The samples on faces in the asset: three accessors, found by their names, for all primitives that the scene draws, in the order of its
// instances. No object refers to them, so that programs that know nothing of them leave the rest alone.
//   _VISIBILITY_LEVELS   SCALAR UNSIGNED_BYTE, one per triangle: SeenOnFaces::levels; sparse where few are not 0
//   _VISIBILITY_SAMPLES  VEC4 as _VISIBILITY, one per sample
//   _VISIBILITY_NUMBERS  SCALAR UNSIGNED_BYTE: the bytes of params_stream.h, instance after instance, if a model is stored
// asset.extras.apertura.faces says what they belong to: "triangles", a hash of all corners in order, their places and what is stored there,
// and of the places of instances that differ in nothing else; "samples", a hash of what the accessors hold; and "numbers", the bytes of
// each instance.
#include "apertura/runtime/asset/asset.h"
#include "apertura/runtime/asset/gltf_writer.h"

namespace apertura {

// Adds the accessors. Returns the description; null where no triangle has samples.
Json addFaces(GltfWriter& writer, const Scene& scene, const BakedVisibility& seen, const Model* stored, int bits);

// Takes the names of such accessors away and returns their indices, for GltfWriter::release.
std::set<size_t> removeFaces(Json& json);

// Reads `asset.seen[i].faces`. Where the accessors are gone, or the triangles or samples are not those that were baked, it adds a line to
// the scene's notes and leaves the faces empty. Throws Error naming the scene if what is there cannot be right.
//   atVertices  of each instance, what its vertices store, -1..1
void readFaces(Asset& asset, const Json& described, std::span<const std::vector<glm::vec4>> atVertices);

// What the samples on faces take in the file, bytes.
size_t bytesOfFaces(const Scene& scene, const BakedVisibility& seen, const Model* stored, int bits);

// Weights of the triangle's corners at a sample of its lattice.
glm::vec3 latticePoint(int sample, int steps);

}  // namespace apertura
