#version 330 core

// The share of the light that reaches each pixel: that of the lamp by colour, and that from all around.

#include "geometry_buffer"
#ifdef SHADOWED
#include "soft_shadow"
#endif

uniform sampler2D occlusion;    // open share and depth, see AmbientOcclusion

out vec4 visible;

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    visible = vec4(1.0);
    if (!is_seen(texelFetch(normal_id, here, 0).w)) return;
#ifdef SHADOWED
    visible.rgb = key_left(texelFetch(position, here, 0).xyz, here);
#endif
#ifdef OCCLUDED
    visible.a = texelFetch(occlusion, here, 0).r;
#endif
}
