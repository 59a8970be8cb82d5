#pragma once
// Turns the rays of one point into what the rivals store of it (shaders/rivals.glsl, shaders/horizon.glsl): the `make` of their recipes.
#include "apertura/bake/fit/fit.h"

namespace apertura {

// The horizon at Count azimuths, each found along its own plane by rays: a search down from the pole for the first blocked direction
// of 64, then by halves. Where the pole itself is blocked, as under a roof, all is: a horizon map holds heights over a plane. Throws
// std::logic_error for samples without a source.
template <int Count>
BakedPoint horizon(const FitTools& tools, const Samples& samples, const mat3& frame, const FitOptions& options);

// Least squares over the hemisphere, by the cosine. The faces along +-X and +-Z are rounded to 5 bits, along +-Y to 6.
BakedPoint ambientCube(const FitTools& tools, const Samples& samples, const mat3& frame, const FitOptions& options);

// The coefficient of Y20 about the mean open direction.
BakedPoint zonalBand(const FitTools& tools, const Samples& samples, const mat3& frame, const FitOptions& options);

// 2 Rings^2 sectors: a sector is open where at least half of its directions are or, if it has none, where the nearest is.
template <int Rings>
BakedPoint sectors(const FitTools& tools, const Samples& samples, const mat3& frame, const FitOptions& options);

}  // namespace apertura
