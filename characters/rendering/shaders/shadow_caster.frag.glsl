#version 330 core

// Distributes the surface over four levels of height, which are blurred separately.

uniform vec4 levels;    // heights of the levels, as shares of the character's height

in float height;

out vec4 covered;

void main() {
    float a = smoothstep(levels.x, levels.y, height);
    float b = smoothstep(levels.y, levels.z, height);
    float c = smoothstep(levels.z, levels.w, height);
    covered = vec4(1.0 - a, a - b, b - c, c);
}
