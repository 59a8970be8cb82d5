#pragma once
// The model parameters that an asset stores beside _VISIBILITY: bytes of one primitive's vertices, without gaps.
//   a model of fixed size   its numbers, vertex after vertex
//   auto                    one byte per vertex: the autoTag of its choice, plus 128 if no model came within the
//                           tolerance; then the numbers of each choice, vertex after vertex
// A number is a normalised signed byte or short (little-endian), as in _VISIBILITY. Field in sh/models.h says what the numbers of a
// model are, and which signs are flags.
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "apertura/sh/models.h"

namespace apertura {

constexpr int kPacking = 2;  // what packAllParams does, and an asset says that it holds

// Packs one element of `allParams` per vertex.
//   toLocal  rotation from the world to the frame of the primitive's vertices
//   bits     per number, 8 or 16
std::vector<std::byte> packAllParams(const Model& model, std::span<const ModelParams> allParams, const mat3& toLocal, int bits);

// Unpacks the parameters of `count` vertices and rotates them by `toWorld`. Throws Error with the cause, without the file's
// name, if there are too few bytes or too many, or a choice is not a model.
//   packing  kPacking; or 1, see fromPacking1
std::vector<ModelParams> unpackAllParams(const Model& model, std::span<const unsigned char> bytes, size_t count, const mat3& toWorld,
                                         int bits, int packing = kPacking);

}  // namespace apertura
