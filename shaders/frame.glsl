// What lights a frame, and what is drawn: the buffers of scene.vert and scene.frag, with the same layout in GLSL (std140,
// std430) and in C++ (runtime/render/renderer.cpp).
#ifndef APERTURA_FRAME_GLSL
#define APERTURA_FRAME_GLSL
#include "bounce.glsl"
#include "sky.glsl"

const int APERTURA_MAX_LIGHTS = 17;  // a sun and sixteen more

// A directional light with an angular radius, or a glowing sphere.
struct APERTURA_STD140 AperturaLight {
    AperturaCapLight cap;  // the directional light
    vec4 sphere;           // xyz: the centre of the sphere, w: its radius > 0, metres; zeros for a directional light
    vec4 radiance;         // rgb, W/m2/sr
    // What the view makes of the light beside others and the sky: arrangedLights (runtime/asset/view.h).
    vec4 behind;   // rgb: the mean radiance of the sky behind a directional light
    ivec4 before;  // x: bit k is set if light k of the frame may stand in front of this one
};

APERTURA_FN bool aperturaIsSphere(AperturaLight light) { return light.sphere.w > 0.0f; }

// The mean radiance of the sky behind a light that is seen as `cap`, rgb, W/m2/sr.
APERTURA_FN vec3 aperturaSkyBehind(AperturaLight light, AperturaCapLight cap, AperturaSky sky) {
    return aperturaIsSphere(light) ? aperturaSkyMean(sky, cap.axis) : vec3(light.behind);
}

struct AperturaFrame {
    mat4 toClip;
    AperturaSky sky;  // from all directions that no light fills
    vec4 eye;         // xyz: world, metres
    vec4 background;  // rgb: what is seen where no surface and no light is, W/m2/sr; w: 1, the sky's picture instead
    vec4 rays[3];     // xyz: a pixel looks along rays[0] + x rays[1] + y rays[2], x and y being -1..1 to the right and down
    vec4 brightest;   // rgb: the largest radiance of any light
    vec4 albedo;      // rgb, 0..1, of surfaces without materials; w: 1, and of all others too
    vec4 around;      // rgb: what the surfaces that block the sky absorb, for APERTURA_BOUNCES_GIVEN
    // x: number of lights, 0..APERTURA_MAX_LIGHTS; y: where the frame's lit vertices begin, in floats; z: floats of each; w: where the
    // faces begin in the indices, 0: there are none
    ivec4 counts;
    AperturaLight lights[APERTURA_MAX_LIGHTS];
};

struct AperturaSceneVertex {
    vec4 position;  // xyz: world, metres; w: the texture coordinate u
    vec4 normal;    // xyz: unit; w: v
};

// Where a vertex lies in the textures of its material, and its own colour.
struct AperturaVertexPaint {
    vec4 places;  // xy: in that of the base colour, zw: of the emission
    vec4 colour;  // linear, with alpha
};

struct AperturaMaterial {
    vec4 baseColour;  // linear, with alpha
    vec4 emissive;    // rgb: linear radiance, W/m2/sr; w: the alpha below which a mask has holes
};

// The cap that a light fills as seen from `position`, metres. A lightClass other than APERTURA_LIGHTS_ANY has no spheres.
APERTURA_FN AperturaCapLight aperturaCapSeenFrom(vec3 position, AperturaLight light, int lightClass) {
    if (lightClass != APERTURA_LIGHTS_ANY) return light.cap;
    AperturaCapLight cap = light.cap;
    if (aperturaIsSphere(light)) cap = aperturaCapOfSphere(vec3(light.sphere) - position, light.sphere.w);
    return cap;
}

#endif
