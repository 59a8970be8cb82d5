// RIVAL: a horizon map, after Max, "Horizon Mapping: Shadows for Bump-Mapped Surfaces", 1988: the elevation of the
// horizon at 16 azimuths about the normal. GLSL and C++ include this text.
#ifndef APERTURA_HORIZON_GLSL
#define APERTURA_HORIZON_GLSL
#include "aperture.glsl"

const int HORIZON_AZIMUTHS = 16;

// E of a cap light over a horizon. h0..h3: sines of elevation at 16 azimuths, counter-clockwise about the normal from
// tangentTo(normal); linear in between.
APERTURA_FN lpfloat irradianceOverHorizon(lpvec3 normal, lpvec4 h0, lpvec4 h1, lpvec4 h2, lpvec4 h3, CapLight light, int lightClass) {
    lpvec3 tangent = tangentTo(normal);
    lpfloat x = dot(tangent, light.axis);
    lpfloat y = dot(cross(normal, tangent), light.axis);
    lpfloat z = dot(normal, light.axis);
    lpfloat turn = atan(y, x) * (lpfloat(HORIZON_AZIMUTHS) / (lpfloat(2.0) * PI));
    lpfloat at = turn < lpfloat(0.0) ? turn + lpfloat(HORIZON_AZIMUTHS) : turn;
    int i = int(at) & 15;
    int j = (i + 1) & 15;
    lpvec4 a = i < 8 ? (i < 4 ? h0 : h1) : (i < 12 ? h2 : h3);
    lpvec4 b = j < 8 ? (j < 4 ? h0 : h1) : (j < 12 ? h2 : h3);
    lpfloat horizon = mix(a[i & 3], b[j & 3], at - floor(at));
    lpfloat above = capRadius(lpfloat(1.0) - horizon) - capRadius(lpfloat(1.0) - z);
    lpfloat t = clamp(lpfloat(0.5) + lpfloat(0.5) * above / max(capRadius(light.height), lpsmall(1e-6)), lpfloat(0.0), lpfloat(1.0));
    return unoccludedIrradiance(normal, light, lightClass) * t
         * (lpfloat(1.0) + lpfloat(0.6687) * (lpfloat(1.0) - t) * (lpfloat(2.0) * t - lpfloat(1.0)));
}

#endif
