#version 330 core

// One direction of a mean over a tile of cells, which does not cross edges. An even tile has one tap more, and its two
// ends count by half.

#include "cells"
#include "surface_weight"

uniform sampler2D source;       // open share, depth
uniform ivec2 direction;
uniform bool last;              // limits the result: the tile is complete

out vec2 open_depth;

void main() {
    ivec2 cell = ivec2(gl_FragCoord.xy), texel = texel_of(cell);
    open_depth = texelFetch(source, cell, 0).xy;
    vec4 surface = texelFetch(normal_id, texel, 0);
    if (surface.w < 0.5)
        return;
    vec3 here = texelFetch(place, texel, 0).xyz;
    float total = 1e-6;         // so that a normal of no length does no harm
    float sum = total * open_depth.x;
    for (int i = -(TILE / 2); i <= TILE / 2; ++i) {
        ivec2 tap = clamp(cell + i * direction, ivec2(0), last_cell);
        vec2 found = texelFetch(source, tap, 0).xy;
        float weight = surface_weight(surface.xyz, here, vec2(stride * i * direction), texel_of(tap), found.y);
        if (TILE > 1 && TILE % 2 == 0 && abs(i) == TILE / 2)
            weight *= 0.5;
        sum += weight * found.x;
        total += weight;
    }
    open_depth.x = last ? clamp(sum / total, 0.0, 1.0) : sum / total;
}
