#version 330 core

// The key light that is left on the table, a square of it.

#include "soft_shadow"

uniform vec3 area;      // lowest x and z of the square, and its side [m]
uniform float side;     // texels along its side

out vec4 left;

void main() {
    vec2 table = area.xy + area.z * gl_FragCoord.xy / side;
    left = vec4(key_left(vec3(table.x, 0.0, table.y), ivec2(gl_FragCoord.xy)), 1.0);
}
