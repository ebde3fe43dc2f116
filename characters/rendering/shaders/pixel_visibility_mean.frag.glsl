#version 330 core

// The mean of the lamp's light over a tile of 4 × 4 cells, whose samples differ; others off its plane do not count, and
// those that a sharp shadow's edge may lie between count less.

#include "geometry_buffer"
#include "tile_mean"
#include "cells"
#include "flat_normal"

uniform sampler2D visibility;
uniform float plane_tolerance;  // [m]

out vec4 visible;

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    visible = texelFetch(visibility, here, 0);
    if (!is_seen(texelFetch(normal_id, here, 0).w)) return;
    vec4 point = texelFetch(position, here, 0);
    vec3 normal = normal_of_number(point.w);
    vec3 sum = vec3(0.0);
    float total = 0.0;
    for (int i = 0; i < TILE_TAPS; ++i) {
        ivec2 there = clamp(here + tile_step(i), ivec2(0), last_cell);
        vec4 other = texelFetch(visibility, there, 0);
        float near = tile_weight(i);
        if (there != here) {
            if (other.a == 0.0 || !is_seen(texelFetch(normal_id, there, 0).w)) continue;
            float off = abs(dot(normal, texelFetch(position, there, 0).xyz - point.xyz));
            near *= other.a * max(1.0 - off / plane_tolerance, 0.0);
        }
        sum += near * other.rgb;
        total += near;
    }
    visible.rgb = sum / total;
}
