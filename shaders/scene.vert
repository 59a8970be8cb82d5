#version 450
#extension GL_GOOGLE_include_directive : require
#include "lattice.glsl"
#include "scene.glsl"

layout(location = 0) out vec3 worldPosition;
layout(location = 1) out vec3 worldNormal;
// The lattice of the triangle's samples: see latticeCellFromFirst. One that has its three vertices alone has one step.
layout(location = 2) out vec2 place;
layout(location = 3) flat out float pitch;
layout(location = 4) flat out uvec3 firstCell;

void main() {
    uint corner = gl_VertexIndex % 3;
    uint first = gl_VertexIndex - corner;
    firstCell = uvec3(indices[first], indices[first + 1], indices[first + 2]);
    SceneVertex v = vertices[firstCell[corner]];
    uint face = frame.counts.w > 0 ? indices[uint(frame.counts.w) + uint(gl_VertexIndex) / 3] : 0;
    uint level = face & 15;
    int steps = latticeSteps(max(int(level), 1));
    if (level > 0) firstCell = (face >> 4) + uvec3(0, 1, steps + 1);
    place = placeInLattice(vec2(corner == 1, corner == 2), float(steps));
    pitch = float(steps) + 1.5;
    worldPosition = v.position.xyz;
    worldNormal = v.normal.xyz;
    gl_Position = frame.toClip * vec4(v.position.xyz, 1.0);
}
