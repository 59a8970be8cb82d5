// Real orthonormal spherical harmonics of the bands 2 to 4, without Condon-Shortley sign, index
// l (l + 1) + m. GLSL and C++ include this text.
#ifndef APERTURA_HARMONICS_GLSL
#define APERTURA_HARMONICS_GLSL
#include "cap.glsl"

// Band 2 as xy, yz, 3z2-1, xz | x2-y2; band 3 and 4 in order of m. As vec4s, because that is how they travel.
struct HighBands {
    vec4 c[6];  // 4..7 | 8..11 | ... | 24 in c[5].x
};

// The basis at unit direction w: Sloan, "Efficient Spherical Harmonic Evaluation", 2013, in Cartesian form.
APERTURA_FN HighBands highBands(vec3 w) {
    float x = w.x;
    float y = w.y;
    float z = w.z;
    float x2 = x * x;
    float y2 = y * y;
    float z2 = z * z;
    HighBands b;
    b.c[0] = vec4(1.0925484f * x * y, 1.0925484f * y * z, 0.9461747f * z2 - 0.3153916f, 1.0925484f * x * z);
    b.c[1] = vec4(0.5462742f * (x2 - y2), 0.5900436f * y * (3.0f * x2 - y2), 2.8906114f * x * y * z,
                  0.4570458f * y * (5.0f * z2 - 1.0f));
    b.c[2] = vec4(0.3731763f * z * (5.0f * z2 - 3.0f), 0.4570458f * x * (5.0f * z2 - 1.0f), 1.4453057f * z * (x2 - y2),
                  0.5900436f * x * (x2 - 3.0f * y2));
    b.c[3] = vec4(2.5033429f * x * y * (x2 - y2), 1.7701308f * y * z * (3.0f * x2 - y2),
                  0.9461747f * x * y * (7.0f * z2 - 1.0f), 0.6690465f * y * z * (7.0f * z2 - 3.0f));
    b.c[4] = vec4(0.1057855f * (z2 * (35.0f * z2 - 30.0f) + 3.0f), 0.6690465f * x * z * (7.0f * z2 - 3.0f),
                  0.4730873f * (x2 - y2) * (7.0f * z2 - 1.0f), 1.7701308f * x * z * (x2 - 3.0f * y2));
    b.c[5] = vec4(0.6258357f * (x2 * (x2 - 3.0f * y2) - y2 * (3.0f * x2 - y2)), 0.0f, 0.0f, 0.0f);
    return b;
}

// What averaging over a cap of this height, 1 - cos(radius), leaves of the bands 1 to 4.
APERTURA_FN vec4 capBlur(float height) {
    float c = 1.0f - height;
    float half1 = 0.5f * (1.0f + c);
    return vec4(half1, half1 * c, 0.25f * half1 * (5.0f * c * c - 1.0f), 0.25f * half1 * c * (7.0f * c * c - 3.0f));
}

#endif
