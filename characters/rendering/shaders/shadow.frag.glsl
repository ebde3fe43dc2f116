#version 330 core

// Multiplies the table by the light that a character leaves.

uniform sampler2D factors;

in vec2 at;

out vec4 factor;

void main() {
    factor = vec4(texture(factors, at).rgb, 1.0);
}
