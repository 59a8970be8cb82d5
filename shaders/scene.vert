#version 450
#extension GL_GOOGLE_include_directive : require
#include "lattice.glsl"
#include "scene.glsl"
#include "texels.glsl"

layout(location = 0) out vec3 worldPosition;
layout(location = 1) out vec3 worldNormal;
// The lattice of the triangle's samples: see aperturaLatticeCellFromFirst. One that has its three vertices alone has one step. In an image:
// the place in texels, 0, and the first texel, width and height.
layout(location = 2) out vec2 place;
layout(location = 3) flat out float pitch;
layout(location = 4) flat out uvec3 firstCell;
// In an image: the face's own normal where its vertices' normals lean from it, and what is seen belongs to the hemisphere about that; else
// 0.
layout(location = 5) flat out vec3 facing;

void main() {
    uint corner = gl_VertexIndex % 3;
    uint first = gl_VertexIndex - corner;
    firstCell = uvec3(indices[first], indices[first + 1], indices[first + 2]);
    uvec3 corners = firstCell;
    AperturaSceneVertex v = vertices[firstCell[corner]];
    facing = vec3(0.0);
    uint face = frame.counts.w > 0 ? indices[uint(frame.counts.w) + uint(gl_VertexIndex) / 3] : 0;
    uint level = face & 15;
    int steps = aperturaLatticeSteps(max(int(level), 1));
    if (level > 0) firstCell = (face >> 4) + uvec3(0, 1, steps + 1);
    place = aperturaPlaceInLattice(vec2(corner == 1, corner == 2), float(steps));
    pitch = float(steps) + 1.5;
    if (level == SAMPLES_ARE_TEXELS) {
        uint size = indices[uint(frame.counts.w) / 3 * 4 + uint(gl_VertexIndex) / 3];
        firstCell = uvec3(face >> 4, size & 65535, size >> 16);
        place = aperturaPlaceInImage(vec2(v.position.w, v.normal.w), float(firstCell.y), float(firstCell.z));
        pitch = 0.0;
        vec3 a = vertices[corners.x].position.xyz;
        facing = aperturaLeaningFace(cross(vertices[corners.y].position.xyz - a, vertices[corners.z].position.xyz - a),
                                     vertices[corners.x].normal.xyz, vertices[corners.y].normal.xyz, vertices[corners.z].normal.xyz);
    }
    worldPosition = v.position.xyz;
    worldNormal = v.normal.xyz;
    gl_Position = frame.toClip * vec4(v.position.xyz, 1.0);
}
