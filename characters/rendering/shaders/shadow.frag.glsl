#version 330 core

// Multiplies the table by the light that a character leaves: the left half of its map.

uniform sampler2D factors;

in vec2 at;

out vec4 factor;

void main() {
    factor = vec4(texture(factors, at * vec2(0.5, 1.0)).rgb, 1.0);
}
