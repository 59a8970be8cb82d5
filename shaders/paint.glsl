// The colours of materials, for the shaders that draw a scene. Define APERTURA_PAINT_CONSTANT, the id of the first of its specialisation
// constants, before.
#ifndef APERTURA_PAINT_GLSL
#define APERTURA_PAINT_GLSL
#include "scene.glsl"

layout(constant_id = APERTURA_PAINT_CONSTANT) const bool painted = false;   // the scene has materials
layout(constant_id = APERTURA_PAINT_CONSTANT + 1) const int alphaKind = 0;  // 0: opaque, 1: a mask, 2: blends

#ifndef APERTURA_PAINT_BINDING
#define APERTURA_PAINT_BINDING 7
#endif
#ifdef APERTURA_VERTEX_STAGE
layout(std430, set = 0, binding = APERTURA_PAINT_BINDING) readonly buffer Paint { AperturaVertexPaint paint[]; };
layout(location = 8) out vec4 places;  // in the textures: base colour, emissive
layout(location = 9) out vec4 vertexColour;

void paintVertex(uint vertex) {
    places = painted ? paint[vertex].places : vec4(0.0);
    vertexColour = painted ? paint[vertex].colour : vec4(1.0);
}
#else
layout(set = 1, binding = 0) uniform MaterialBlock { AperturaMaterial material; };
layout(set = 1, binding = 1) uniform sampler2D baseTexture;
layout(set = 1, binding = 2) uniform sampler2D emissiveTexture;
layout(location = 8) in vec4 places;
layout(location = 9) in vec4 vertexColour;

// A hole of a mask. What it discards is discarded last, so that its neighbours have derivatives.
bool inHole = false;

// Linear.
vec4 baseColour() {
    if (!painted) return vec4(frame.albedo.rgb, 1.0);
    vec4 base = material.baseColour * vertexColour * texture(baseTexture, places.xy);
    inHole = alphaKind == 1 && base.a < material.emissive.w;
    if (alphaKind != 2) base.a = 1.0;
    return frame.albedo.w > 0.0 ? vec4(frame.albedo.rgb, base.a) : base;
}

// 1 - the albedo of what blocks the sky about a surface of this base colour.
vec3 absorbedAround(int bounces, vec4 base) {
    return bounces == APERTURA_BOUNCES_OWN ? max(1.0 - base.rgb, vec3(APERTURA_LEAST_ABSORBED)) : frame.around.rgb;
}

// What leaves a surface of this base colour under an irradiance.
vec4 painting(vec4 base, vec3 irradiance) {
    vec3 colour = base.rgb / APERTURA_PI * irradiance;
    if (painted && frame.albedo.w == 0.0) colour += material.emissive.rgb * texture(emissiveTexture, places.zw).rgb;
    if (inHole) discard;
    return vec4(colour, base.a);
}
#endif

#endif
