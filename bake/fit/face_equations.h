#pragma once
// The equations that samples on faces are fitted by.
#include <array>
#include <span>

#include "apertura/bake/fit/face.h"
#include "apertura/bake/fit/face_unknowns.h"
#include "apertura/bake/fit/least_squares.h"
#include "apertura/runtime/asset/asset.h"

namespace apertura {

// A cell's samples, numbered as in their lattice, with their weights.
std::array<Term, 3> termsOf(const AperturaLatticeCell& cell);

// What is fitted: vertices and samples, or vertices alone, as if no face had samples.
enum class Fitted { All, Vertices };

// `faces`: those of the instance.
Unknowns unknownsOf(const Scene& scene, size_t instance, std::span<const Face> faces, Fitted what = Fitted::All);

// Each probe of the faces says what mixing samples makes at its place; ties draw neighbours together. `seen`: what the vertices see, each a
// value more.
LeastSquares equationsOf(const Unknowns& unknowns, std::span<const Face> faces, const Surface& surface, std::span<const Visibility> seen,
                         Fitted what = Fitted::All);

}  // namespace apertura
