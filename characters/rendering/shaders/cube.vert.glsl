#version 330 core

uniform mat4 clip_from_cube;

in vec3 position;

void main() {
    gl_Position = clip_from_cube * vec4(position, 1.0);
}
