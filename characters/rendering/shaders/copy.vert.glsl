#version 330 core

// A rectangle of the picture into a window, which counts its rows from below.

uniform vec4 place;     // left, top, width, height, as shares of the picture
uniform vec2 filled;    // share of the texture that is in use

out vec2 at;

void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    at = corner * filled;
    vec2 picture = place.xy + corner * place.zw;
    gl_Position = vec4(picture.x * 2.0 - 1.0, 1.0 - picture.y * 2.0, 0.0, 1.0);
}
