// How two pictures are shown beside each other: the buffer of compose.frag, with the same layout (std140) in GLSL and in C++.
#ifndef APERTURA_COMPOSE_GLSL
#define APERTURA_COMPOSE_GLSL

struct AperturaCompose {
    vec4 show;      // x: pixels from the left where the second picture begins; y: what radiances are multiplied by; z: 1, the neutral
                    // tone curve; w: 1, their difference instead of the second
    ivec4 samples;  // x, y: samples of a pixel across and down, of each picture
};

#endif
