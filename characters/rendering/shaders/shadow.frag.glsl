#version 330 core

// Multiplies the table by the light that a character leaves.

uniform sampler2D factors;

in vec2 at;

out vec4 factor;

#include "cube_outlines"

void main() {
    factor = vec4(mix(vec3(1.0), texture(factors, vec2(0.5 * at.x, at.y)).rgb, not_hidden()), 1.0);
}
