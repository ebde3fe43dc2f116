#version 330 core

// What is left of all light on the table, as a factor of sRGB values. The key light is the mean of 4 × 4 texels: what
// differs within a tile of that size becomes even.

#include "tile_mean"

uniform sampler2D left;     // key light by colour, and light from all around
uniform vec3 key;           // share of the key light in the light on the table, by channel

out vec4 factor;

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy), last = textureSize(left, 0) - 1;
    vec3 mean = vec3(0.0);
    for (int i = 0; i < TILE_TAPS; ++i)
        mean += tile_weight(i) * texelFetch(left, clamp(here + tile_step(i), ivec2(0), last), 0).rgb;
    vec3 light = key * mean + (1.0 - key) * texelFetch(left, here, 0).a;
    factor = vec4(pow(light, vec3(1.0 / 2.2)).bgr, 1.0);
}
