// The light that light.comp finds at the vertices, once for a frame, and lit.vert and lit.frag interpolate. Define APERTURA_LIT as
// `readonly` or `writeonly` before.
#ifndef APERTURA_LIT_GLSL
#define APERTURA_LIT_GLSL
#include "scene.glsl"

// Of each vertex: the visible fractions of the frame's lights, and the sky's E at the vertex's own normal.
layout(std430, set = 0, binding = 4) APERTURA_LIT buffer LitVertices { float litVertices[]; };

// Where those of a vertex begin: the sky, then the lights.
uint litVertex(uint vertex) { return uint(frame.counts.y) + vertex * uint(frame.counts.z); }

#endif
