// The mean of a tile of 4 × 4 texels around one: it has one tap more along each side, and its ends count by half.

const int TILE_TAPS = 25;

ivec2 tile_step(int tap) {
    return ivec2(tap % 5, tap / 5) - 2;
}

float tile_weight(int tap) {
    vec2 side = mix(vec2(1.0), vec2(0.5), equal(abs(tile_step(tap)), ivec2(2)));
    return side.x * side.y / 16.0;
}
