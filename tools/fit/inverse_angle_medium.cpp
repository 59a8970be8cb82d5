// The reciprocal of the pseudo-angle between two axes, for lights of up to 10 degrees.
// fits shaders/aperture.glsl aperturaOverlapOf 0.7054 0.0833
#include "inverse_angle.h"

double error() { return apertura::test::inverseAngleError(apertura::APERTURA_LIGHTS_MEDIUM); }
