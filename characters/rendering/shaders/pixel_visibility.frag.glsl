#version 330 core

// The share of the lamp's light that reaches each cell, by colour.

#include "geometry_buffer"
#include "soft_shadow"

out vec4 visible;

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    visible = vec4(1.0);
    if (is_seen(texelFetch(normal_id, here, 0).w))
        visible.rgb = key_left(texelFetch(position, here, 0).xyz, here);
}
