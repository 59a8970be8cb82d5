#version 450
#extension GL_GOOGLE_include_directive : require
#define APERTURA_LIT writeonly
#include "lit.glsl"
#include "vertex_params.glsl"
AperturaLight aperturaLightAt(int frameOfAll, int i) { return frame.lights[i]; }
#include "lights.glsl"

// Lights every vertex once for a frame. What is kept is the fraction of each light that is visible, so that a pixel's own normal and its
// own view of a lamp still count.
layout(local_size_x = 64) in;

void lightVertex(uint vertex) {
    vec3 normal = vertices[vertex].normal.xyz;
    uint at = litVertex(vertex);
    for (int i = 0; i < frame.counts.x; ++i) {
        AperturaCapLight light = aperturaCapSeenFrom(vertices[vertex].position.xyz, frame.lights[i], lightClass);
        // A pixel may face a light that its vertex does not: there the vertex is lit as if it leant towards it.
        vec3 leaning = normalize(normal + max(2.0 * light.sinRadius + 0.05 - dot(normal, light.axis), 0.0) * light.axis);
        float open = aperturaUnoccludedIrradiance(leaning, light, lightClass);
        float e = aperturaIrradianceBeside(model, receiverOf(vertex, leaning), vertices[vertex].position.xyz, 0, i, lightClass);
        litVertices[at + uint(i) + 1] = clamp(e / max(open, 1e-12), 0.0, 1.0);
    }
    litVertices[at] = aperturaSkyIrradiance(model, receiverOf(vertex, normal));
}

void main() {
    uint step = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
    for (uint vertex = gl_GlobalInvocationID.x; vertex < vertices.length(); vertex += step) lightVertex(vertex);
}
