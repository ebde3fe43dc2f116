#version 330 core

// The mean of 4 × 4 texels: what differs within a tile of that size becomes even.

uniform sampler2D source;

out vec4 mean;

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy), last = textureSize(source, 0) - 1;
    mean = vec4(0.0);
    for (int i = 0; i < 16; ++i)
        mean += texelFetch(source, clamp(here + ivec2(i & 3, i >> 2) - 2, ivec2(0), last), 0) / 16.0;
}
