// Real orthonormal spherical harmonics of the bands 2 to 4, without Condon-Shortley sign, index
// l (l + 1) + m. GLSL and C++ include this text.
#ifndef APERTURA_HARMONICS_GLSL
#define APERTURA_HARMONICS_GLSL
#include "cap.glsl"

// Band 2 in the order xy, yz, 3z2-1, xz, x2-y2; bands 3 and 4 in order of m. Grouped in vec4s, like the slots of a
// receiver.
struct AperturaHighBands {
    AperturaVec4 c[6];  // 4..7 | 8..11 | ... | 24 in c[5].x
};

// The basis at unit direction w: Sloan, "Efficient Spherical Harmonic Evaluation", 2013, in Cartesian form.
APERTURA_FN AperturaHighBands aperturaHighBands(AperturaVec3 w) {
    AperturaFloat x = w.x;
    AperturaFloat y = w.y;
    AperturaFloat z = w.z;
    AperturaFloat x2 = x * x;
    AperturaFloat y2 = y * y;
    AperturaFloat z2 = z * z;
    AperturaHighBands b;
    b.c[0] = AperturaVec4(AperturaFloat(1.0925484) * x * y, AperturaFloat(1.0925484) * y * z,
                          AperturaFloat(0.9461747) * z2 - AperturaFloat(0.3153916), AperturaFloat(1.0925484) * x * z);
    b.c[1] = AperturaVec4(AperturaFloat(0.5462742) * (x2 - y2), AperturaFloat(0.5900436) * y * (AperturaFloat(3.0) * x2 - y2),
                          AperturaFloat(2.8906114) * x * y * z,
                          AperturaFloat(0.4570458) * y * (AperturaFloat(5.0) * z2 - AperturaFloat(1.0)));
    b.c[2] = AperturaVec4(AperturaFloat(0.3731763) * z * (AperturaFloat(5.0) * z2 - AperturaFloat(3.0)),
                          AperturaFloat(0.4570458) * x * (AperturaFloat(5.0) * z2 - AperturaFloat(1.0)),
                          AperturaFloat(1.4453057) * z * (x2 - y2), AperturaFloat(0.5900436) * x * (x2 - AperturaFloat(3.0) * y2));
    b.c[3] = AperturaVec4(AperturaFloat(2.5033429) * x * y * (x2 - y2), AperturaFloat(1.7701308) * y * z * (AperturaFloat(3.0) * x2 - y2),
                          AperturaFloat(0.9461747) * x * y * (AperturaFloat(7.0) * z2 - AperturaFloat(1.0)),
                          AperturaFloat(0.6690465) * y * z * (AperturaFloat(7.0) * z2 - AperturaFloat(3.0)));
    b.c[4] = AperturaVec4(AperturaFloat(0.1057855) * (z2 * (AperturaFloat(35.0) * z2 - AperturaFloat(30.0)) + AperturaFloat(3.0)),
                          AperturaFloat(0.6690465) * x * z * (AperturaFloat(7.0) * z2 - AperturaFloat(3.0)),
                          AperturaFloat(0.4730873) * (x2 - y2) * (AperturaFloat(7.0) * z2 - AperturaFloat(1.0)),
                          AperturaFloat(1.7701308) * x * z * (x2 - AperturaFloat(3.0) * y2));
    b.c[5] = AperturaVec4(AperturaFloat(0.6258357) * (x2 * (x2 - AperturaFloat(3.0) * y2) - y2 * (AperturaFloat(3.0) * x2 - y2)),
                          AperturaFloat(0.0), AperturaFloat(0.0), AperturaFloat(0.0));
    return b;
}

// The factors by which averaging over a cap of this height, 1 - cos(radius), scales the bands 1 to 4.
APERTURA_FN AperturaVec4 aperturaCapBlur(AperturaFloat height) {
    AperturaFloat c = AperturaFloat(1.0) - height;
    AperturaFloat half1 = AperturaFloat(0.5) * (AperturaFloat(1.0) + c);
    return AperturaVec4(half1, half1 * c, AperturaFloat(0.25) * half1 * (AperturaFloat(5.0) * c * c - AperturaFloat(1.0)),
                        AperturaFloat(0.25) * half1 * c * (AperturaFloat(7.0) * c * c - AperturaFloat(3.0)));
}

#endif
