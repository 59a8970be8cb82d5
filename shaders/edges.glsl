// The mean over a light of a product of visibilities, from the means of its factors and how their edges lie to each
// other: two that share an edge let through what one does, and not the square of it. GLSL and C++ include this text.
#ifndef APERTURA_EDGES_GLSL
#define APERTURA_EDGES_GLSL
#include "cap.glsl"

// The covariance over a light's directions w of dot(a, w) and dot(b, w), in quarters of its squared sine, from dot(a, b)
// and what a and b have along its axis: across the axis w varies by a quarter of that, along it by a twelfth of the
// squared height. Within 6 % of their deviations to 45 degrees.
APERTURA_FN lpfloat covariance(lpfloat product, lpfloat alongA, lpfloat alongB, CapLight light) {
    return product - light.axialWeight * alongA * alongB;
}

// How far two edges coincide, as a light sees them, from the correlation of their planes across it: 1 they are one,
// 0 they cross, -1 they face each other. After 2 / pi asin(c), the law of two normal variables of correlation c at
// their medians (Sheppard, "On the application of the theory of error to cases of normal distribution and normal
// correlation", 1899), above it by up to 0.13 where the edges nearly agree: a disc has no tails.
APERTURA_FN lpfloat edgeAlignment(lpfloat correlation) {
    lpfloat c = clamp(correlation, -lpfloat(1.0), lpfloat(1.0));
    return c * (lpfloat(0.64) + lpfloat(0.36) * c * c);
}

// The mean of a product of two from their means p and q, 0..1, and their edgeAlignment w: of one edge it is the less of the
// two, and of edges that face each other what both exceed 1 by.
APERTURA_FN lpfloat meanOfTwo(lpfloat p, lpfloat q, lpfloat w) {
    return p * q + abs(w) * ((w > lpfloat(0.0) ? min(p, q) : max(p + q - lpfloat(1.0), lpfloat(0.0))) - p * q);
}

// Of three, from theirs and those of their pairs (01, 02, 12): each pair adds what it is beyond the product of its
// means, and no set holds more than a part of it does.
APERTURA_FN lpfloat meanOfThree(lpvec3 p, lpvec3 pair) {
    lpfloat sum = p.x * pair.z + p.y * pair.y + p.z * pair.x - lpfloat(2.0) * p.x * p.y * p.z;
    lpfloat least = max(max(pair.x + pair.y - p.x, pair.x + pair.z - p.y), max(pair.y + pair.z - p.z, lpfloat(0.0)));
    lpfloat none = lpfloat(1.0) - p.x - p.y - p.z + pair.x + pair.y + pair.z;  // and all three
    return min(max(sum, least), max(min(min(pair.x, pair.y), min(pair.z, none)), lpfloat(0.0)));
}

// Of four, from the pairs 01, 23 and 02, 12, 03, 13: the first pair is one, and the mean of it with each of the others a
// mean of three. Another order of the four would give up to 0.04 more or less.
APERTURA_FN lpfloat meanOfFour(lpvec4 p, lpvec2 two, lpvec4 pair) {
    lpvec2 withPair = lpvec2(meanOfThree(lpvec3(p), lpvec3(two.x, pair.x, pair.y)),
                             meanOfThree(lpvec3(p.x, p.y, p.w), lpvec3(two.x, pair.z, pair.w)));
    return meanOfThree(lpvec3(two.x, p.z, p.w), lpvec3(withPair, two.y));
}

// What products of two to four factors are on average.
struct MeanProducts {
    lpvec2 pair;   // of 0 and 1, and of 2 and 3
    lpfloat last;  // of all but the first two
    lpfloat all;
};

// Of factors whose edges are all softer than the light is wide: nothing is lost by the product of means. Of fewer than
// four the rest of `p` is 1.
APERTURA_FN MeanProducts plainProducts(lpvec4 p) { return MeanProducts(lpvec2(p.x * p.y, p.z * p.w), p.z * p.w, p.x * p.y * p.z * p.w); }

// Of `count` factors by their edgeAlignments: w1 of 01; w2 of 02, 12; w3 of 03, 13, 23.
APERTURA_FN MeanProducts meanProducts(int count, lpvec4 p, lpfloat w1, lpvec2 w2, lpvec3 w3) {
    MeanProducts m;
    m.pair = lpvec2(meanOfTwo(p.x, p.y, w1), p.z);
    m.last = p.z;
    m.all = m.pair.x;
    if (count >= 3) {
        lpvec2 withThird = lpvec2(meanOfTwo(p.x, p.z, w2.x), meanOfTwo(p.y, p.z, w2.y));
        m.all = meanOfThree(lpvec3(p), lpvec3(m.pair.x, withThird.x, withThird.y));
        if (count >= 4) {
            m.pair.y = meanOfTwo(p.z, p.w, w3.z);
            m.last = m.pair.y;
            m.all = meanOfFour(p, m.pair, lpvec4(withThird.x, withThird.y, meanOfTwo(p.x, p.w, w3.x), meanOfTwo(p.y, p.w, w3.y)));
        }
    }
    return m;
}

#endif
