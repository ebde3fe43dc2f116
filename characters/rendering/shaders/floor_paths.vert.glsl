#version 330 core

uniform mat4 clip_from_table;

in vec2 position;
in vec2 local;
in vec3 shape;
in vec3 color;

out vec2 at;
out vec3 capsule;
out vec3 paint;

void main() {
    at = local;
    capsule = shape;
    paint = color;
    gl_Position = clip_from_table * vec4(position.x, 0.0, position.y, 1.0);
}
