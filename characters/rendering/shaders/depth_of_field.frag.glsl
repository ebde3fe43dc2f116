#version 330 core

// Gathers the light of a texel from its circle of confusion (Huang 2013, ch. 12.1; see Focus.radius). A sharp texel
// shows its own light. A tap counts if its own circle covers the texel, or if it is behind it; where no character is
// seen, those in front spread over the picture, but not over a real cube that is nearer than they are.

#include "geometry_buffer"
#include "encoding"
#include "light_sum"
#include "tile_offset"
#include "disc_taps"

const int MOST_TAPS = 32, FEWEST_TAPS = 8;

uniform sampler2D light;        // of the characters, linear, and 1 where one is seen
uniform float half_aperture;    // of the lens, times the focal length [texels m]
uniform vec2 focus;             // nearest and furthest depth that is sharp [m]
uniform float widest;           // largest circle of this picture [texels]
uniform ivec2 last_texel;
uniform vec2 clip_depth;        // depth in clip space is the first + the second / z

out vec4 color;

float radius_at(float z) {
    return min(half_aperture * max(max(1.0 / z - 1.0 / focus.x, 1.0 / focus.y - 1.0 / z), 0.0), widest);
}

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    bool seen = is_seen(texelFetch(normal_id, here, 0).w);
    float depth = seen ? texelFetch(position, here, 0).z : 1e3;
    float radius = seen ? radius_at(depth) : widest;
    gl_FragDepth = 0.0;
    if (seen && radius < 0.5) {
        color = vec4(shown(light_sum(here)), 1.0);
        return;
    }
    int taps = clamp(int(2.0 * radius * radius), FEWEST_TAPS, MOST_TAPS);
    vec2 offset = tile_offset(here);
    vec4 sum = seen ? vec4(texelFetch(light, here, 0).rgb, 1.0) : vec4(0.0);
    float total = 1.0, depths = 0.0;
    for (int i = 0; i < taps; ++i) {
        float away = radius * disc_reach(i, taps, offset);
        ivec2 there = clamp(here + ivec2(round(away * disc_direction(i, offset))), ivec2(0), last_texel);
        if (!is_seen(texelFetch(normal_id, there, 0).w)) {
            total += 1.0;
            continue;
        }
        float z = texelFetch(position, there, 0).z, own = radius_at(z);
        bool covers = own >= 0.5 && away <= own + 0.5;
        if (seen && !covers && z < depth) continue;
        // A small circle puts more of its light on each texel of it.
        float weight = seen ? 1.0 : covers ? radius * radius / (own * own) : 0.0;
        sum += weight * vec4(texelFetch(light, there, 0).rgb, 1.0);
        depths += weight * z;
        total += max(weight, 1.0);
    }
    float share = seen ? sum.a / total : min(sum.a / total, 1.0);
    if (share <= 0.0) discard;
    if (!seen) gl_FragDepth = 0.5 + 0.5 * (clip_depth.x + clip_depth.y * sum.a / depths);
    color = vec4(share * shown(sum.rgb / sum.a), share);
}
