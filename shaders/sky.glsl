// A sky whose radiance differs with direction, as a receiver sees it through its opening. GLSL and C++ include this text.
//
// The mean radiance of an opening is near that of the sky in the direction from which its light comes on average, blurred by as much as its
// light is spread. Both are in one vector: the mean of the open directions, weighted by their cosines to the normal. Its length is 1 for an
// opening in one direction and 2/3 for a whole hemisphere.
#ifndef APERTURA_SKY_GLSL
#define APERTURA_SKY_GLSL
#include "cap.glsl"

// SH bands 0 to 2 of a sky's radiance, as polynomials of a direction (x, y, z), rgb each, W/m2/sr: 1; x, y, z; then xx - yy, zz - yy, xy,
// yz, zx (runtime/asset/sky.cpp). A sky of one radiance has the first alone.
struct AperturaSky {
    vec4 bands[9];
};

// The cosine-weighted mean of an opening's directions. Exact for a small opening and for an open hemisphere, and at a receiver without
// an opening the zero vector; between, its error, weighted by E, is 0.06 RMS over the built-in scenes. Fitted: tools/fit/centroid.cpp.
//   normal     unit
//   direction  D, sr
//   area       A, sr
APERTURA_FN AperturaVec3 aperturaOpeningCentroid(AperturaVec3 normal, AperturaVec3 direction, AperturaFloat area) {
    AperturaVec3 mean = direction / max(area, aperturaSmall(1e-6));
    AperturaFloat cosine = dot(mean, normal);
    AperturaFloat share = area / (AperturaFloat(2.0) * APERTURA_PI);
    AperturaFloat along = AperturaFloat(1.155) - AperturaFloat(2.861) * cosine;
    AperturaFloat up = AperturaFloat(0.1666667) - AperturaFloat(0.742) * (cosine - AperturaFloat(0.5))
                     + AperturaFloat(0.298) * (AperturaFloat(1.0) - share) - along * cosine;
    return mean + share * (along * mean + up * normal);
}

// The mean radiance of a sky through an opening with this aperturaOpeningCentroid, rgb, >= 0. Of band 1 it takes the length of the
// centroid, k; of band 2 what a cap with cosine weights has at the same k, within 0.002: k^2 (17 + 63 k^2) / 80.
APERTURA_FN vec3 aperturaSkyMean(AperturaSky sky, vec3 middle) {
    float x = middle.x;
    float y = middle.y;
    float z = middle.z;
    float narrow = 17.0f / 80.0f + 63.0f / 80.0f * dot(middle, middle);
    vec4 first = sky.bands[0] + sky.bands[1] * x + sky.bands[2] * y + sky.bands[3] * z;
    vec4 second = sky.bands[4] * (x * x - y * y) + sky.bands[5] * (z * z - y * y) + sky.bands[6] * (x * y) + sky.bands[7] * (y * z)
                + sky.bands[8] * (z * x);
    return max(vec3(first + narrow * second), vec3(0.0f));
}

#endif
