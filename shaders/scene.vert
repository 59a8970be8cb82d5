#version 450
#extension GL_GOOGLE_include_directive : require
#include "lattice.glsl"
#include "texels.glsl"
#include "vertex_params.glsl"
AperturaLight aperturaLightAt(int frameOfAll, int i) { return frame.lights[i]; }
#include "lights.glsl"
#define APERTURA_PAINT_CONSTANT 5
#define APERTURA_VERTEX_STAGE
#include "paint.glsl"

// APERTURA_AT_VERTICES  1: what the pixel needs of the samples is read here and interpolated, for scenes whose samples are the vertices
//                       and models of at most one slot that may be interpolated; 0: the pixel reads its samples itself
layout(location = 0) out vec3 worldPosition;
layout(location = 1) out vec3 worldNormal;
#if APERTURA_AT_VERTICES
layout(location = 2) out vec4 seenHere;  // D, A, sr
layout(location = 3) out vec4 slot;
layout(location = 4) out vec4 skyHere;  // rgb: the mean radiance of the sky that is let through or, without bounces, what it gives, W/m2;
                                        // w: E of a sky of unit radiance
layout(location = 5) out vec3 bounceShare;
layout(location = 6) out vec3 bounceTowards;
layout(constant_id = 7) const bool oneLight = false;
layout(constant_id = 8) const int bounces = APERTURA_BOUNCES_NONE;
#else
// The lattice of the triangle's samples: see aperturaLatticeCellFromFirst. One that has its three vertices alone has one step. In an image:
// the place in texels, 0, and the first texel, width and height.
layout(location = 2) out vec2 place;
layout(location = 3) flat out float pitch;
layout(location = 4) flat out uvec3 firstCell;
// In an image: the face's own normal where its vertices' normals lean from it, and what is seen belongs to the hemisphere about that; else
// 0.
layout(location = 5) flat out vec3 facing;

// Where the samples of the corner's triangle are.
void placeSamples(uint corner, AperturaSceneVertex v) {
    uint first = gl_VertexIndex - corner;
    firstCell = uvec3(indices[first], indices[first + 1], indices[first + 2]);
    uvec3 corners = firstCell;
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
}
#endif

void main() {
#if APERTURA_AT_VERTICES
    uint vertex = gl_VertexIndex;
    seenHere = seen[vertex];
    AperturaReceiver receiver = receiverOf(vertex, vertices[vertex].normal.xyz);
    slot = slots > 0 ? receiver.params[0] : vec4(0.0);
    // Of one light that is a point for it, a pixel needs of a soft aperture one number, which is linear in its four.
    if (oneLight && aperturaIsPointFor(model, lightClass)) slot = vec4(0.0, 0.0, 0.0, slot.w + dot(slot.xyz, frame.lights[0].cap.axis));
    skyHere.w = aperturaSkyIrradiance(model, receiver);
    skyHere.rgb = aperturaSkyThrough(model, receiver.normal, seenHere, frame.sky);
    if (bounces == APERTURA_BOUNCES_NONE) skyHere.rgb *= skyHere.w;
    bounceShare = bounceTowards = vec3(0.0);
    if (bounces == APERTURA_BOUNCES_BAKED) {
        AperturaBounce bounce = bounceOf(vertex);
        bounceShare = bounce.share;
        bounceTowards = bounce.towards;
    }
#else
    uint vertex = indices[gl_VertexIndex];
    placeSamples(gl_VertexIndex % 3, vertices[vertex]);
#endif
    AperturaSceneVertex v = vertices[vertex];
    worldPosition = v.position.xyz;
    worldNormal = v.normal.xyz;
    paintVertex(vertex);
    gl_Position = frame.toClip * vec4(v.position.xyz, 1.0);
}
