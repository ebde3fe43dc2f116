#version 330 core

// One direction of a Gaussian blur; its width differs between the four levels. The map's halves do not mix.

const int BLUR_TAPS = 10;

uniform sampler2D source;
uniform ivec2 direction;
uniform vec4 weights[BLUR_TAPS];
uniform int left;       // first column of the half
uniform int side;       // columns of the half, and rows

out vec4 softened;

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    ivec2 low = ivec2(left, 0), high = low + side - 1;
    softened = weights[0] * texelFetch(source, here, 0);
    for (int i = 1; i < BLUR_TAPS; ++i)
        softened += weights[i] * (texelFetch(source, min(here + i * direction, high), 0)
                                + texelFetch(source, max(here - i * direction, low), 0));
}
