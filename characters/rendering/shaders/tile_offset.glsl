// Offset of samples, 0…1, another in each texel of a tile of 4 × 4. The mean of any 2 × 2 texels is even too.
vec2 tile_offset(ivec2 texel) {
    ivec2 cell = texel & 3;
    return (vec2((cell & 1) * 2 + (cell >> 1)) + 0.5) / 4.0;
}
