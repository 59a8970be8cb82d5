// The buffers of a scene, for its vertex and fragment shaders.
#ifndef APERTURA_SCENE_GLSL
#define APERTURA_SCENE_GLSL
#include "frame.glsl"

layout(set = 0, binding = 0) uniform FrameBlock { Frame frame; };
layout(std430, set = 0, binding = 1) readonly buffer Vertices { SceneVertex vertices[]; };
layout(std430, set = 0, binding = 2) readonly buffer Indices { uint indices[]; };

#endif
