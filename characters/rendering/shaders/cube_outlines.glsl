// How much of a place on the table is not behind a real cube: outside of all outlines, whose sides tell how
// far inside a place is [px]. It is soft over one pixel.
const int MAX_CUBES = 8, MAX_SIDES = 10;
uniform int cube_count;      // how many there are
uniform int longest;    // how many sides they have at most
uniform vec3 outlines[MAX_CUBES * MAX_SIDES];

float not_hidden() {
    vec3 here = vec3(gl_FragCoord.xy, 1.0);
    float share = 1.0;
    for (int cube = 0; cube < cube_count; ++cube) {
        float inside = 1.0;
        for (int side = 0; side < longest; ++side)
            inside = min(inside, dot(outlines[cube * MAX_SIDES + side], here) + 0.5);
        share *= 1.0 - max(inside, 0.0);
    }
    return share;
}
