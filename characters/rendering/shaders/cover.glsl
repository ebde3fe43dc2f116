// Share of a pixel that a hand covers; what is drawn behind it shows in the rest. Texels are pixels.
uniform sampler2D cover;
uniform vec2 cover_corner;  // in the region [px]
uniform vec2 cover_size;    // [px]

float covered(vec2 pixel) {
    vec2 at = pixel - cover_corner;
    if (any(lessThan(at, vec2(0.0))) || any(greaterThan(at, cover_size))) return 0.0;
    // Beyond its last row and column are texels of covers before.
    return texture(cover, clamp(at, vec2(0.5), cover_size - 0.5) / vec2(textureSize(cover, 0))).r;
}
