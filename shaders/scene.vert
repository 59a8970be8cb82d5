#version 450
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"

layout(set = 0, binding = 0) uniform FrameBlock { Frame frame; };

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 visibility;
layout(location = 3) in vec4 aperture;
layout(location = 4) in vec4 soft;

layout(location = 0) out vec3 worldPosition;
layout(location = 1) out vec3 worldNormal;
layout(location = 2) out vec4 seenVisibility;
layout(location = 3) out vec4 seenAperture;
layout(location = 4) out vec4 seenSoft;

void main() {
    worldPosition = position;
    worldNormal = normal;
    seenVisibility = visibility;
    seenAperture = aperture;
    seenSoft = soft;
    gl_Position = frame.toClip * vec4(position, 1.0);
}
