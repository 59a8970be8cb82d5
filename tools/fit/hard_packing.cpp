// Where the bytes of a hard lobe's rim are finest, and what is left of them for lobes that have none.
// fits sh/params_packing.cpp kRimShare 0.9
// fits sh/params_packing.cpp kRimCurve 1.37
// with sh/params_packing.cpp
// reason: chosen on a building of small openings, whose lobes are nearly all open, with numbers that are rounded together.
// links fit
// links scene
// links sampling
// links directions
// links asset
// links measure
// links sh
#include "bytes.h"

double error() { return apertura::test::meanErrorOf({apertura::APERTURA_MODEL_FIRM_2, apertura::APERTURA_MODEL_FIRM_4}); }
