// The reciprocal of the pseudo-angle between two axes, for lights of any size.
// fits shaders/aperture.glsl aperturaOverlapOf 0.71188 0.10650 0.01124
#include "inverse_angle.h"

double error() { return apertura::test::inverseAngleError(apertura::APERTURA_LIGHTS_ANY); }
