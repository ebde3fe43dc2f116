#version 330 core

// The characters' layer; where it is twice as fine, the linear filter returns the mean of four texels.
// SOFT: blurred as the camera's picture is; four means around the pixel blur enough. GRAIN: with its noise.

uniform sampler2D characters;
uniform vec2 corner;    // of their area in the region [px]
uniform float fineness; // texels for each pixel, along each side
#ifdef SOFT
uniform float spread;   // of the four means [px]
#endif
#ifdef GRAIN
uniform sampler2D grain;    // its sides are powers of two
uniform ivec2 shift;    // of the grain, new in each picture
uniform float noise;    // of the picture's values, for a grain of the whole range
#endif

out vec4 color;

vec4 mean_at(vec2 pixel) {
    return texture(characters, fineness * pixel / vec2(textureSize(characters, 0)));
}

void main() {
    vec2 pixel = gl_FragCoord.xy - corner;
#ifdef SOFT
    vec2 aside = vec2(spread, -spread);
    color = 0.25 * (mean_at(pixel + aside.xx) + mean_at(pixel + aside.xy)
                  + mean_at(pixel + aside.yx) + mean_at(pixel + aside.yy));
#else
    color = mean_at(pixel);
#endif
#ifdef GRAIN
    ivec2 at = (ivec2(gl_FragCoord.xy) + shift) & (textureSize(grain, 0) - 1);
    color.rgb += color.a * noise * (texelFetch(grain, at, 0).rgb - 0.5);
#endif
}
