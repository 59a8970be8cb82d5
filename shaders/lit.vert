#version 450
#extension GL_GOOGLE_include_directive : require
#define APERTURA_LIT readonly
#include "lit.glsl"
#include "models.glsl"
#include "stored_bounce.glsl"
AperturaLight aperturaLightAt(int frameOfAll, int i) { return frame.lights[i]; }
#include "lights.glsl"
#define APERTURA_PAINT_CONSTANT 3
#define APERTURA_VERTEX_STAGE
#include "paint.glsl"

layout(constant_id = 0) const int model = APERTURA_MODEL_SOFT;
layout(std430, set = 0, binding = 5) readonly buffer Seen { vec4 visibility[]; };  // D, A, sr, of each vertex

layout(constant_id = 1) const int more = APERTURA_MAX_LIGHTS / 4;  // vec4s of lights after the first light

layout(location = 0) out vec3 worldPosition;
layout(location = 1) out vec3 worldNormal;
layout(location = 2) out vec4 seen;      // D, or x: the sky's E, for models whose sky needs more; w: the first light's fraction
layout(location = 3) out vec3 radiance;  // of the sky through the opening
layout(location = 4) out vec4 visible[APERTURA_MAX_LIGHTS / 4];  // the other lights' fractions
layout(constant_id = 5) const int bounces = APERTURA_BOUNCES_NONE;
layout(location = 10) out vec4 around;       // D, A, sr, for bounces that are not baked;
layout(location = 11) out vec3 bounceShare;  // and those that are
layout(location = 12) out vec3 bounceTowards;

void main() {
    AperturaSceneVertex v = vertices[gl_VertexIndex];
    uint at = litVertex(gl_VertexIndex);
    worldPosition = v.position.xyz;
    worldNormal = v.normal.xyz;
    seen = vec4(aperturaSkyNeedsMore(model) ? vec3(litVertices[at], 0.0, 0.0) : visibility[gl_VertexIndex].xyz, litVertices[at + 1]);
    radiance = aperturaSkyThrough(model, v.normal.xyz, visibility[gl_VertexIndex], frame.sky);
    for (int i = 0; i < more; ++i)
        for (int k = 0; k < 4; ++k) visible[i][k] = litVertices[at + uint(4 * i + k + 2)];
    around = visibility[gl_VertexIndex];
    bounceShare = bounceTowards = vec3(0.0);
    if (bounces == APERTURA_BOUNCES_BAKED) {
        AperturaBounce bounce = bounceOf(gl_VertexIndex);
        bounceShare = bounce.share;
        bounceTowards = bounce.towards;
    }
    paintVertex(gl_VertexIndex);
    gl_Position = frame.toClip * vec4(v.position.xyz, 1.0);
}
