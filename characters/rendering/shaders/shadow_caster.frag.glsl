#version 330 core

// Shares the surface out between four heights, which are blurred apart.

uniform vec4 levels;    // the four heights, as shares of the character's

in float height;

out vec4 covered;

void main() {
    float a = smoothstep(levels.x, levels.y, height);
    float b = smoothstep(levels.y, levels.z, height);
    float c = smoothstep(levels.z, levels.w, height);
    covered = vec4(1.0 - a, a - b, b - c, c);
}
