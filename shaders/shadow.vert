#version 450
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"
#include "shadow.glsl"
#define APERTURA_PAINT_CONSTANT 0
#define APERTURA_PAINT_BINDING 4
#define APERTURA_VERTEX_STAGE
#include "paint.glsl"

layout(set = 0, binding = 3) uniform ShadowBlock { AperturaShadowView shadow; };

// APERTURA_MAP  1: as the light sees it, for the map; 0: as the camera does
#if !APERTURA_MAP
layout(location = 0) out vec3 worldPosition;
layout(location = 1) out vec3 worldNormal;
#endif

void main() {
    uint vertex = indices[gl_VertexIndex];
    vec4 position = vec4(vertices[vertex].position.xyz, 1.0);
    paintVertex(vertex);
#if APERTURA_MAP
    gl_Position = shadow.toLight * position;
#else
    worldPosition = position.xyz;
    worldNormal = vertices[vertex].normal.xyz;
    gl_Position = frame.toClip * position;
#endif
}
