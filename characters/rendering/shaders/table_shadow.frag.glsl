#version 330 core

// The light that is left on a square of the table: key light by colour, and light from all around.

#include "soft_shadow"

uniform vec3 area;          // lowest x and z of the square, and its side [m]
uniform float side;         // texels along its side
uniform sampler2D openness; // light from all around, encoded, in each texel

out vec4 left;

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    vec2 table = area.xy + area.z * gl_FragCoord.xy / side;
    left = vec4(key_left(vec3(table.x, 0.0, table.y), here), pow(texelFetch(openness, here, 0).r, 2.2));
}
