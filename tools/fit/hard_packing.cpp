// Where the bytes of a hard lobe's rim are finest, and what is left of them for lobes that have none.
// fits sh/params_packing.cpp kRimShare 0.9
// fits sh/params_packing.cpp kRimCurve 1.37
// with sh/params_packing.cpp
// reason: numbers are rounded each by itself here. Chosen together (bake/fit/rounding.h), on Sponza's small openings, shares of .88 to .92
//   erred least.
// links fit
// links scene
// links sampling
// links directions
// links asset
// links measure
// links sh
#include "bytes.h"

double error() { return apertura::test::meanErrorOf({apertura::APERTURA_MODEL_FIRM_2, apertura::APERTURA_MODEL_FIRM_4}); }
