#version 330 core

// The mean of the lamp's light over a tile of 4 × 4 cells, whose samples differ; others of another depth do not count.

#include "geometry_buffer"
#include "tile_mean"
#include "cells"

uniform sampler2D visibility;
uniform float depth_tolerance;  // [m]

out vec4 visible;

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    visible = texelFetch(visibility, here, 0);
    if (!is_seen(texelFetch(normal_id, here, 0).w)) return;
    float depth = texelFetch(position, here, 0).z;
    vec3 sum = vec3(0.0);
    float total = 0.0;
    for (int i = 0; i < TILE_TAPS; ++i) {
        ivec2 there = clamp(here + tile_step(i), ivec2(0), last_cell);
        float near = tile_weight(i) * max(1.0 - abs(texelFetch(position, there, 0).z - depth) / depth_tolerance, 0.0);
        if (!is_seen(texelFetch(normal_id, there, 0).w)) continue;
        sum += near * texelFetch(visibility, there, 0).rgb;
        total += near;
    }
    visible.rgb = sum / total;
}
