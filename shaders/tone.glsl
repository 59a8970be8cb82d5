// From linear radiance to what a display of limited range shows. GLSL and C++ include this text.
#ifndef APERTURA_TONE_GLSL
#define APERTURA_TONE_GLSL
#ifndef APERTURA_FN
#define APERTURA_FN
#endif

// The Khronos PBR neutral tone mapper (Khronos Group, 2024): colours below 0.76 keep hue and saturation, brighter ones are compressed to 1
// and whiten. `colour`: linear, >= 0; the result 0..1.
APERTURA_FN vec3 aperturaNeutralTone(vec3 colour) {
    const float start = 0.76f;
    const float desaturation = 0.15f;
    float least = min(colour.x, min(colour.y, colour.z));
    vec3 c = colour - vec3(least < 0.08f ? least - 6.25f * least * least : 0.04f);
    float peak = max(c.x, max(c.y, c.z));
    if (peak < start) return c;
    float room = 1.0f - start;
    float compressed = 1.0f - room * room / (peak + room - start);
    float white = 1.0f - 1.0f / (desaturation * (peak - compressed) + 1.0f);
    return mix(c * (compressed / peak), vec3(compressed), white);
}

#endif
