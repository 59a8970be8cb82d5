// Real orthonormal spherical harmonics of the bands 2 to 4, without Condon-Shortley sign, index
// l (l + 1) + m. GLSL and C++ include this text.
#ifndef APERTURA_HARMONICS_GLSL
#define APERTURA_HARMONICS_GLSL
#include "cap.glsl"

// Band 2 in the order xy, yz, 3z2-1, xz, x2-y2; bands 3 and 4 in order of m. Grouped in vec4s, like the slots of a
// receiver.
struct HighBands {
    lpvec4 c[6];  // 4..7 | 8..11 | ... | 24 in c[5].x
};

// The basis at unit direction w: Sloan, "Efficient Spherical Harmonic Evaluation", 2013, in Cartesian form.
APERTURA_FN HighBands highBands(lpvec3 w) {
    lpfloat x = w.x;
    lpfloat y = w.y;
    lpfloat z = w.z;
    lpfloat x2 = x * x;
    lpfloat y2 = y * y;
    lpfloat z2 = z * z;
    HighBands b;
    b.c[0] = lpvec4(lpfloat(1.0925484) * x * y, lpfloat(1.0925484) * y * z, lpfloat(0.9461747) * z2 - lpfloat(0.3153916),
                    lpfloat(1.0925484) * x * z);
    b.c[1] = lpvec4(lpfloat(0.5462742) * (x2 - y2), lpfloat(0.5900436) * y * (lpfloat(3.0) * x2 - y2), lpfloat(2.8906114) * x * y * z,
                    lpfloat(0.4570458) * y * (lpfloat(5.0) * z2 - lpfloat(1.0)));
    b.c[2] = lpvec4(lpfloat(0.3731763) * z * (lpfloat(5.0) * z2 - lpfloat(3.0)),
                    lpfloat(0.4570458) * x * (lpfloat(5.0) * z2 - lpfloat(1.0)), lpfloat(1.4453057) * z * (x2 - y2),
                    lpfloat(0.5900436) * x * (x2 - lpfloat(3.0) * y2));
    b.c[3] = lpvec4(lpfloat(2.5033429) * x * y * (x2 - y2), lpfloat(1.7701308) * y * z * (lpfloat(3.0) * x2 - y2),
                    lpfloat(0.9461747) * x * y * (lpfloat(7.0) * z2 - lpfloat(1.0)),
                    lpfloat(0.6690465) * y * z * (lpfloat(7.0) * z2 - lpfloat(3.0)));
    b.c[4] = lpvec4(lpfloat(0.1057855) * (z2 * (lpfloat(35.0) * z2 - lpfloat(30.0)) + lpfloat(3.0)),
                    lpfloat(0.6690465) * x * z * (lpfloat(7.0) * z2 - lpfloat(3.0)),
                    lpfloat(0.4730873) * (x2 - y2) * (lpfloat(7.0) * z2 - lpfloat(1.0)),
                    lpfloat(1.7701308) * x * z * (x2 - lpfloat(3.0) * y2));
    b.c[5] = lpvec4(lpfloat(0.6258357) * (x2 * (x2 - lpfloat(3.0) * y2) - y2 * (lpfloat(3.0) * x2 - y2)), lpfloat(0.0), lpfloat(0.0),
                    lpfloat(0.0));
    return b;
}

// The factors by which averaging over a cap of this height, 1 - cos(radius), scales the bands 1 to 4.
APERTURA_FN lpvec4 capBlur(lpfloat height) {
    lpfloat c = lpfloat(1.0) - height;
    lpfloat half1 = lpfloat(0.5) * (lpfloat(1.0) + c);
    return lpvec4(half1, half1 * c, lpfloat(0.25) * half1 * (lpfloat(5.0) * c * c - lpfloat(1.0)),
                  lpfloat(0.25) * half1 * c * (lpfloat(7.0) * c * c - lpfloat(3.0)));
}

#endif
