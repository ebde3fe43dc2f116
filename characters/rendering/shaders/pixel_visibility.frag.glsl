#version 330 core

// The share of the lamp's light that reaches each cell, by colour.

#define ON_SURFACE
#include "geometry_buffer"
#include "flat_normal"
#include "soft_shadow"

out vec4 visible;               // and how much of a tile the penumbra is wide, at most 1

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    visible = vec4(1.0, 1.0, 1.0, 0.0);
    if (!is_seen(texelFetch(normal_id, here, 0).w)) return;
    vec4 point = texelFetch(position, here, 0);
    vec3 seen = (lamp_from_point * vec4(point.xyz, 1.0)).xyz;
    vec3 normal = mat3(lamp_from_point) * normal_of_number(point.w);
    float facing = dot(normal, seen), cosine = abs(facing) / length(seen);
    // What looks away from the lamp is shadowed by itself: only others count.
    vec3 plane = facing < 0.0 ? normal / facing : vec3(0.0);
    float width;
    visible.rgb = key_left(Receiver(seen.xy / seen.z, seen.z - shadow_range.x, plane, cosine), here, width);
    visible.a = min(width / tile_m, 1.0);
}
