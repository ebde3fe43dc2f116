#version 330 core

// The open share of each texel, from those of the cells around it, without crossing edges.

#include "cells"
#include "surface_weight"

uniform sampler2D source;       // open share, depth

out vec2 open_depth;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    open_depth = vec2(1.0, 0.0);
    vec4 surface = texelFetch(normal_id, texel, 0);
    if (surface.w < 0.5)
        return;
    vec3 here = texelFetch(place, texel, 0).xyz;
    vec2 at = vec2(texel - stride / 2) / float(stride);
    ivec2 corner = ivec2(floor(at));
    vec2 part = at - vec2(corner);
    float total = 1e-9, sum = total;
    for (int i = 0; i < 4; ++i) {
        ivec2 step = ivec2(i & 1, i >> 1), cell = clamp(corner + step, ivec2(0), last_cell), there = texel_of(cell);
        vec2 share = mix(1.0 - part, part, vec2(step)), found = texelFetch(source, cell, 0).xy;
        float weight = surface_weight(surface.xyz, here, vec2(there - texel), there, found.y);
        weight = found.y > 0.0 ? max(share.x * share.y, 1e-3) * max(weight, 1e-4) : 0.0;
        sum += weight * found.x;
        total += weight;
    }
    open_depth = vec2(sum / total, here.z);
}
