#version 330 core

// Light that the character leaves on the table: no key light in its shadow, less ambient light near it.
// The factor multiplies linear light; a power of it multiplies the encoded picture the same way. Both halves of
// the map are blurred along z here; along x, they are already.

const int BLUR_TAPS = 10;

uniform sampler2D map;
uniform vec4 key_weights[BLUR_TAPS];
uniform vec4 sky_weights[BLUR_TAPS];
uniform ivec4 used;     // first column and row that can have a shadow, last column and row
uniform int side;       // columns of each half of the map
uniform vec3 key;       // share of the key light in the light on the table, by channel
uniform vec4 sky_occlusion; // share of the ambient light that each level can keep

out vec4 factor;

void main() {
    ivec2 here = clamp(ivec2(gl_FragCoord.xy), used.xy, used.zw);
    ivec2 half_ = ivec2(side, 0);
    vec4 blocked = key_weights[0] * texelFetch(map, here, 0);
    vec4 closed = sky_weights[0] * texelFetch(map, here + half_, 0);
    for (int i = 1; i < BLUR_TAPS; ++i) {
        ivec2 above = ivec2(here.x, min(here.y + i, used.w)), below = ivec2(here.x, max(here.y - i, used.y));
        blocked += key_weights[i] * (texelFetch(map, above, 0) + texelFetch(map, below, 0));
        closed += sky_weights[i] * (texelFetch(map, above + half_, 0) + texelFetch(map, below + half_, 0));
    }
    float shade = min(dot(blocked, vec4(1.0)), 1.0);
    // It is dark under a foot, not black: foot and table reflect some light.
    float sky = min(dot(closed, sky_occlusion), 0.78);
    vec3 light = key * (1.0 - shade) + (1.0 - key) * (1.0 - sky);
    factor = vec4(pow(light, vec3(1.0 / 2.2)).bgr, 1.0);
}
