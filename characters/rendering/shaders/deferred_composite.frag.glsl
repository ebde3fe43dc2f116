#version 330 core

// The sum of the light of a texel, as the picture shows it. LINEAR: as it is.

#include "geometry_buffer"
#include "encoding"
#include "light_sum"

out vec4 color;

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    if (!is_seen(texelFetch(normal_id, here, 0).w)) discard;
    vec3 sum = light_sum(here);
#ifdef LINEAR
    color = vec4(sum, 1.0);
#else
    color = vec4(shown(sum), 1.0);
#endif
}
