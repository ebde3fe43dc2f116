// Taps that cover a disc evenly: the golden angle turns each against the last (H. Vogel, 1979). The offset, 0…1, shifts
// and turns all of them.

float disc_reach(int tap, int taps, vec2 offset) {
    return sqrt((float(tap) + offset.y) / float(taps));
}

vec2 disc_direction(int tap, vec2 offset) {
    float angle = float(tap) * 2.39996323 + 6.2831853 * offset.x;
    return vec2(cos(angle), sin(angle));
}
