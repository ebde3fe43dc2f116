#version 330 core

// A Gaussian blur along x; its width differs between the four levels. The map's halves do not mix.

const int BLUR_TAPS = 10;

uniform sampler2D source;
uniform vec4 weights[BLUR_TAPS];
uniform int first;      // column that can have a shadow
uniform int last;

out vec4 softened;

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    softened = weights[0] * texelFetch(source, here, 0);
    for (int i = 1; i < BLUR_TAPS; ++i)
        softened += weights[i] * (texelFetch(source, ivec2(min(here.x + i, last), here.y), 0)
                                + texelFetch(source, ivec2(max(here.x - i, first), here.y), 0));
}
