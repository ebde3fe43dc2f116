#version 330 core

// A rectangle of the picture, copied into a window, whose rows count from below.

uniform vec4 place;     // left, top, width, height, as shares of the picture's size
uniform vec2 filled;    // share of the texture's size that is in use

out vec2 at;

void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    at = corner * filled;
    vec2 picture = place.xy + corner * place.zw;
    gl_Position = vec4(picture.x * 2.0 - 1.0, 1.0 - picture.y * 2.0, 0.0, 1.0);
}
