#pragma once
// Which of the numbers that bytes can hold stand for lobes and caps best.
#include "apertura/sh/models.h"

namespace apertura {

// How many times as far as paramsError says what bytes hold may lie from what was fitted: 3 where numbers are chosen together, else 1.
int roundedFarther(const Model& model, int bits);

// The parameters of a stored model as an asset of 8 bits will return them. Each number of a hard lobe or a cap is one of the three that are
// nearest to it, and those of one lobe are chosen together, so that its edge moves least where light passes it: light of 5 degrees then
// errs by half of what it does where each is rounded by itself (tests/rounding_test.cpp). All else, and all at 16 bits, is left for the
// asset to round.
//   world    of the parameters: their frame is the world's
//   normal   about which the point sees, unit, world
//   toLocal  orthogonal: to the frame in which they are stored
ModelParams roundedParams(const Model& model, const ModelParams& world, const vec3& normal, const mat3& toLocal, int bits);

}  // namespace apertura
