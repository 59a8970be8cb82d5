// Where the bytes of a lobe's slope and of a quadric's bend are finest.
// fits sh/params_packing.cpp kMiddleSlope 4
// fits sh/params_packing.cpp kMiddleBend 10
// with sh/params_packing.cpp
// reason: assets hold these bytes, and files of 0.1 are read for ever.
// links fit
// links scene
// links sampling
// links directions
// links asset
// links measure
// links sh
#include "bytes.h"

double error() { return apertura::test::meanErrorOf({apertura::APERTURA_MODEL_SOFT_2, apertura::APERTURA_MODEL_SOFT_L2}); }
