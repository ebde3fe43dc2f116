// The share of the lamp's light that reaches a texel, from one value for each cell; those off its plane do not count.

#include "cells"
#include "flat_normal"

uniform sampler2D visibility;   // of the lamp by colour
uniform sampler2D pixel_position;
uniform float plane_tolerance;  // [m]

// `point` is the position of the texel and the number of its triangle's normal.
vec3 visible_at(ivec2 texel, vec4 point) {
    vec3 normal = normal_of_number(point.w);
    vec2 at = vec2(texel - stride / 2) / float(stride);
    ivec2 corner = ivec2(floor(at));
    vec2 part = at - vec2(corner);
    vec3 sum = vec3(0.0);
    float total = 0.0;
    for (int i = 0; i < 4; ++i) {
        ivec2 step = ivec2(i & 1, i >> 1);
        ivec2 pixel = clamp(corner + step, ivec2(0), last_cell);
        vec2 share = mix(1.0 - part, part, vec2(step));
        float off = abs(dot(normal, texelFetch(pixel_position, pixel, 0).xyz - point.xyz)) / plane_tolerance;
        float weight = max(share.x * share.y, 1e-3) * max(1.0 - off, 1e-4);
        sum += weight * texelFetch(visibility, pixel, 0).rgb;
        total += weight;
    }
    return sum / total;
}
