#version 330 core

uniform mat4 clip_from_cube;    // the cube's edge is 1 long

in vec3 position;
in vec3 normal;

out vec3 at;
flat out vec3 outward;

void main() {
    at = position;
    outward = normal;
    gl_Position = clip_from_cube * vec4(position, 1.0);
}
