#version 450
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"
#include "shadow.glsl"

layout(set = 0, binding = 3) uniform ShadowBlock { AperturaShadowView shadow; };

void main() { gl_Position = shadow.toLight * vec4(vertices[indices[gl_VertexIndex]].position.xyz, 1.0); }
