#version 330 core

// One direction of a Gaussian whose width differs between the four heights. The map's halves do not mix.

const int TAPS = 16;

uniform sampler2D source;
uniform ivec2 direction;
uniform vec4 key_weights[TAPS];     // left half
uniform vec4 sky_weights[TAPS];     // right half
uniform int side;

out vec4 softened;

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    bool sky = here.x >= side;
    ivec2 low = ivec2(sky ? side : 0, 0), high = low + side - 1;
    softened = (sky ? sky_weights[0] : key_weights[0]) * texelFetch(source, here, 0);
    for (int i = 1; i < TAPS; ++i) {
        vec4 weight = sky ? sky_weights[i] : key_weights[i];
        softened += weight * (texelFetch(source, clamp(here + i * direction, low, high), 0)
                            + texelFetch(source, clamp(here - i * direction, low, high), 0));
    }
}
