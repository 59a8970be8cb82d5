#pragma once
// What an asset stores beside _VISIBILITY: the parameters of one primitive's vertices as bytes, without gaps.
//   a model of fixed size   its numbers, vertex after vertex
//   auto                    a byte a vertex, the autoTag of its choice, and 128 more where no model
//                           came within the tolerance; then the numbers that each choice has, vertex after vertex
// A number is a normalised signed byte or short (little-endian), as in _VISIBILITY.
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "sh/models.h"

namespace apertura {

// Bytes of the parameters, turned by `toLocal` into the frame of the primitive's vertices.
std::vector<std::byte> packAllParams(const Model& model, std::span<const ModelParams> allParams, const mat3& toLocal, int bits);

// Parameters of `count` vertices, turned by `toWorld`. Throws Error with the cause (the caller names the file) where the bytes
// are too few, too many, or name a choice that is none.
std::vector<ModelParams> unpackAllParams(const Model& model, std::span<const unsigned char> bytes, size_t count, const mat3& toWorld,
                                         int bits);

}  // namespace apertura
