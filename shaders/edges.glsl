// The mean over a light of a product of visibilities, from the means of its factors and the alignment of their edges: two
// factors with the same edge let through what one does, not the square of it. GLSL and C++ include this text.
#ifndef APERTURA_EDGES_GLSL
#define APERTURA_EDGES_GLSL
#include "cap.glsl"

// The covariance of dot(a, w) and dot(b, w) over a light's directions w, in units of sinRadius^2 / 4. The variance of w
// is one such unit across the light's axis, and height^2 / 12 along it. Within 7 % of the product of the two deviations
// for radii up to 45 degrees.
//   product         dot(a, b)
//   alongA, alongB  dot(a, light.axis), dot(b, light.axis)
APERTURA_FN AperturaFloat aperturaCovariance(AperturaFloat product, AperturaFloat alongA, AperturaFloat alongB, AperturaCapLight light) {
    return product - light.axialWeight * alongA * alongB;
}

// How far two edges coincide as a light sees them: 1 they are the same, 0 they cross, -1 they face each other.
// `correlation`: of their planes over the light; clamped to -1..1. It follows 2 / pi asin(c), the law for two normal
// variables of correlation c at their medians (Sheppard, "On the application of the theory of error to cases of normal
// distribution and normal correlation", 1899), and exceeds it by up to 0.13 where the edges nearly agree, because a disc
// has no tails. Fitted: tools/fit/edges.cpp.
APERTURA_FN AperturaFloat aperturaEdgeAlignment(AperturaFloat correlation) {
    AperturaFloat c = clamp(correlation, -AperturaFloat(1.0), AperturaFloat(1.0));
    return c * (AperturaFloat(0.64) + AperturaFloat(0.36) * c * c);
}

// The mean of a product of two factors, from their means p and q (0..1) and their aperturaEdgeAlignment w; linear between
//   w = 1   (same edge)     min(p, q)
//   w = 0   (crossing)      p q
//   w = -1  (facing edges)  max(p + q - 1, 0)
APERTURA_FN AperturaFloat aperturaMeanOfTwo(AperturaFloat p, AperturaFloat q, AperturaFloat w) {
    return p * q + abs(w) * ((w > AperturaFloat(0.0) ? min(p, q) : max(p + q - AperturaFloat(1.0), AperturaFloat(0.0))) - p * q);
}

// The mean of a product of three factors, from their means p and those of their pairs (01, 02, 12):
// p0 p1 p2 + the sum of p_k (pair_ij - p_i p_j), within the bounds of inclusion-exclusion. Within 0.002 RMS (0.055 max)
// of brute force for edges across a disc (tests/edges_test.cpp).
APERTURA_FN AperturaFloat aperturaMeanOfThree(AperturaVec3 p, AperturaVec3 pair) {
    AperturaFloat sum = p.x * pair.z + p.y * pair.y + p.z * pair.x - AperturaFloat(2.0) * p.x * p.y * p.z;
    AperturaFloat least = max(max(pair.x + pair.y - p.x, pair.x + pair.z - p.y), max(pair.y + pair.z - p.z, AperturaFloat(0.0)));
    AperturaFloat none = AperturaFloat(1.0) - p.x - p.y - p.z + pair.x + pair.y + pair.z;  // mean of "no factor", plus that of all three
    return min(max(sum, least), max(min(min(pair.x, pair.y), min(pair.z, none)), AperturaFloat(0.0)));
}

// The mean of a product of four factors, from the means of the pairs 01, 23 (`two`) and 02, 12, 03, 13 (`pair`). It takes
// factors 0 and 1 as one factor, and uses aperturaMeanOfThree throughout. Another order of the four would change the result by up
// to 0.04. Within 0.004 RMS (0.055 max) of brute force, as aperturaMeanOfThree.
APERTURA_FN AperturaFloat aperturaMeanOfFour(AperturaVec4 p, AperturaVec2 two, AperturaVec4 pair) {
    AperturaVec2 withPair = AperturaVec2(aperturaMeanOfThree(AperturaVec3(p), AperturaVec3(two.x, pair.x, pair.y)),
                                         aperturaMeanOfThree(AperturaVec3(p.x, p.y, p.w), AperturaVec3(two.x, pair.z, pair.w)));
    return aperturaMeanOfThree(AperturaVec3(two.x, p.z, p.w), AperturaVec3(withPair, two.y));
}

// The means of products of two to four factors.
struct AperturaMeanProducts {
    AperturaVec2 pair;   // factors 0 and 1; factors 2 and 3
    AperturaFloat last;  // all factors but the first two
    AperturaFloat all;
};

// For factors whose edges are all softer than the light is wide: the mean of a product is then the product of the means.
// With fewer than four factors, the rest of `p` is 1.
APERTURA_FN AperturaMeanProducts aperturaPlainProducts(AperturaVec4 p) {
    return AperturaMeanProducts(AperturaVec2(p.x * p.y, p.z * p.w), p.z * p.w, p.x * p.y * p.z * p.w);
}

// For `count` factors, 2 to 4, from their means p and their aperturaEdgeAlignments: w1 of 01; w2 of 02, 12; w3 of 03, 13, 23.
APERTURA_FN AperturaMeanProducts aperturaMeanProducts(int count, AperturaVec4 p, AperturaFloat w1, AperturaVec2 w2, AperturaVec3 w3) {
    AperturaMeanProducts m;
    m.pair = AperturaVec2(aperturaMeanOfTwo(p.x, p.y, w1), p.z);
    m.last = p.z;
    m.all = m.pair.x;
    if (count >= 3) {
        AperturaVec2 withThird = AperturaVec2(aperturaMeanOfTwo(p.x, p.z, w2.x), aperturaMeanOfTwo(p.y, p.z, w2.y));
        m.all = aperturaMeanOfThree(AperturaVec3(p), AperturaVec3(m.pair.x, withThird.x, withThird.y));
        if (count >= 4) {
            m.pair.y = aperturaMeanOfTwo(p.z, p.w, w3.z);
            m.last = m.pair.y;
            m.all = aperturaMeanOfFour(
                p, m.pair, AperturaVec4(withThird.x, withThird.y, aperturaMeanOfTwo(p.x, p.w, w3.x), aperturaMeanOfTwo(p.y, p.w, w3.y)));
        }
    }
    return m;
}

#endif
