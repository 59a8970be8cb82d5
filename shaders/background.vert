#version 450

layout(location = 0) out vec2 screen;  // -1..1 to the right and down

// One triangle over the whole picture, farther than all else.
void main() {
    screen = vec2(gl_VertexIndex == 1 ? 3.0 : -1.0, gl_VertexIndex == 2 ? 3.0 : -1.0);
    gl_Position = vec4(screen, 0.0, 1.0);
}
