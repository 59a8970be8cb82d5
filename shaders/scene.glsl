// The buffers of a scene, for its vertex and fragment shaders.
#ifndef APERTURA_SCENE_GLSL
#define APERTURA_SCENE_GLSL
#include "frame.glsl"

layout(set = 0, binding = 0) uniform FrameBlock { AperturaFrame frame; };
layout(std430, set = 0, binding = 1) readonly buffer Vertices { AperturaSceneVertex vertices[]; };
// Three vertices of each triangle; then, if there are samples beside the vertices, one number of each: the place of the first sample of its
// lattice times 16, and the lattice's level. 0: its samples are its vertices. SAMPLES_ARE_TEXELS: the samples are those of its mesh's
// image; then follows, if there are images, one number more of each triangle: its image's width, and 65536 times the height.
layout(std430, set = 0, binding = 2) readonly buffer Indices { uint indices[]; };

const uint SAMPLES_ARE_TEXELS = 15;

#endif
