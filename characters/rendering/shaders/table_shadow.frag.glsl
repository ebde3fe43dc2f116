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
    vec3 seen = (lamp_from_point * vec4(table.x, 0.0, table.y, 1.0)).xyz;
    Receiver receiver = Receiver(seen.xy / seen.z, seen.z - shadow_range.x);
    float width;
    left = vec4(key_left(receiver, here, width), pow(texelFetch(openness, here, 0).r, 2.2));
}
