#version 450
#extension GL_GOOGLE_include_directive : require
#include "scene.glsl"

// For the fragments: the three corners of the triangle (indices of vertices) and their barycentric weights.
layout(location = 0) out vec3 worldPosition;
layout(location = 1) out vec3 worldNormal;
layout(location = 2) out vec3 weights;
layout(location = 3) flat out uvec3 corners;
layout(location = 4) flat out uint face;  // of the triangle: see Indices

void main() {
    uint corner = gl_VertexIndex % 3;
    uint first = gl_VertexIndex - corner;
    corners = uvec3(indices[first], indices[first + 1], indices[first + 2]);
    face = frame.counts.w > 0 ? indices[uint(frame.counts.w) + uint(gl_VertexIndex) / 3] : 0;
    SceneVertex v = vertices[corners[corner]];
    worldPosition = v.position.xyz;
    worldNormal = v.normal.xyz;
    weights = vec3(corner == 0, corner == 1, corner == 2);
    gl_Position = frame.toClip * vec4(v.position.xyz, 1.0);
}
