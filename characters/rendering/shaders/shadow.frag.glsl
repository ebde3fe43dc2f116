#version 330 core

// Multiplies the table by the light that a character leaves.

uniform sampler2D factors;
uniform float map_share;    // of the columns of the factors that this map has

in vec2 at;

out vec4 factor;

#include "hidden"

void main() {
    vec2 place = at * vec2(map_share, 1.0);
    factor = vec4(mix(vec3(1.0), texture(factors, place).rgb, not_hidden()), 1.0);
}
