#include "apertura/sh/aperture.h"

namespace apertura {

AperturaAperture toAperture(const Visibility& any, const vec3& normal) {
    const Visibility v = clampToPossible(any);
    const float length = glm::length(v.direction);
    // Below a thousandth of the area, the direction is noise of the projection.
    const vec3 axis = length > 1e-3f * v.area ? v.direction / length : normal;
    return aperturaMakeAperture(axis, v.area / (2 * APERTURA_PI));
}

}  // namespace apertura
