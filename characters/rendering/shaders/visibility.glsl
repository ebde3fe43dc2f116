// The share of the lamp's light that reaches a texel, from one value for each cell; those off its plane do not count.

#include "cells"
#include "flat_normal"

const float LEAST_WEIGHT = 0.02;

uniform sampler2D visibility;   // of the lamp by colour
uniform sampler2D pixel_position;
uniform float plane_tolerance;  // [m]

// Adds what the cells of a square around a texel tell it. `at` is its place, `point` as below.
void add_cells(vec2 at, ivec2 corner, int side, vec4 point, inout vec3 sum, inout float total) {
    vec3 normal = normal_of_number(point.w);
    for (int i = 0; i < side * side; ++i) {
        ivec2 cell = corner + ivec2(i % side, i / side);
        ivec2 pixel = clamp(cell, ivec2(0), last_cell);
        vec2 share = max(1.0 - abs(at - vec2(cell)) / float(side / 2), 0.0);
        float off = abs(dot(normal, texelFetch(pixel_position, pixel, 0).xyz - point.xyz)) / plane_tolerance;
        float weight = max(share.x * share.y, 1e-3) * max(1.0 - off, 1e-5);
        sum += weight * texelFetch(visibility, pixel, 0).rgb;
        total += weight;
    }
}

// `point` is the position of the texel and the number of its triangle's normal.
vec3 visible_at(ivec2 texel, vec4 point) {
    vec2 at = vec2(texel - stride / 2) / float(stride);
    ivec2 corner = ivec2(floor(at));
    vec3 sum = vec3(0.0);
    float total = 0.0;
    add_cells(at, corner, 2, point, sum, total);
    // At an edge, all four may be of what is before it.
    if (total < LEAST_WEIGHT) add_cells(at, corner - 1, 4, point, sum, total);
    return sum / total;
}
