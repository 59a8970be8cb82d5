#version 450
#extension GL_GOOGLE_include_directive : require
#define APERTURA_PAINT_CONSTANT 0
#define APERTURA_PAINT_BINDING 4
#include "paint.glsl"

// Of a mask, the depth alone: its holes cast no shadow.
void main() {
    baseColour();
    if (inHole) discard;
}
