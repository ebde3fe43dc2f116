#version 330 core

// Multiplies the table by the light that the characters leave: key light by colour, and light from all around.

uniform sampler2D left;         // key light on the square of the table
uniform sampler2D openness;     // light from all around, encoded, in each pixel of the region
uniform vec3 key;               // share of the key light in the light on the table, by channel

in vec2 at;

out vec4 factor;

#include "cube_outlines"

void main() {
    vec3 lit = texture(left, at).rgb;
    float open = pow(texelFetch(openness, ivec2(gl_FragCoord.xy), 0).r, 2.2);
    vec3 light = pow(key * lit + (1.0 - key) * open, vec3(1.0 / 2.2));
    factor = vec4(mix(vec3(1.0), light.bgr, not_hidden()), 1.0);
}
