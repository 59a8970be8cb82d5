// RIVAL: a horizon map, after Max, "Horizon Mapping: Shadows for Bump-Mapped Surfaces", 1988: the height of
// the horizon at 16 azimuths about the normal. GLSL and C++ include this text.
#ifndef APERTURA_HORIZON_GLSL
#define APERTURA_HORIZON_GLSL
#include "aperture.glsl"

const int HORIZON_AZIMUTHS = 16;

// E of a cap light over a horizon: sine of its elevation at 16 azimuths, linear in between.
APERTURA_FN float irradianceOverHorizon(vec3 normal, vec4 h0, vec4 h1, vec4 h2, vec4 h3, CapLight light, int lightClass) {
    vec3 tangent = tangentTo(normal);
    float x = dot(tangent, light.axis);
    float y = dot(cross(normal, tangent), light.axis);
    float z = dot(normal, light.axis);
    float turn = atan(y, x) * (float(HORIZON_AZIMUTHS) / (2.0f * PI));
    float at = turn < 0.0f ? turn + float(HORIZON_AZIMUTHS) : turn;
    int i = int(at) & 15;
    int j = (i + 1) & 15;
    vec4 a = i < 8 ? (i < 4 ? h0 : h1) : (i < 12 ? h2 : h3);
    vec4 b = j < 8 ? (j < 4 ? h0 : h1) : (j < 12 ? h2 : h3);
    float horizon = mix(a[i & 3], b[j & 3], at - floor(at));
    float above = capRadius(1.0f - horizon) - capRadius(1.0f - z);
    float t = clamp(0.5f + 0.5f * above / max(capRadius(light.height), 1e-6f), 0.0f, 1.0f);
    return unoccludedIrradiance(normal, light, lightClass) * t * (1.0f + 0.6687f * (1.0f - t) * (2.0f * t - 1.0f));
}

#endif
