// How much of a place on the table is not behind a real cube: outside of all outlines, whose sides tell how
// far inside a place is [px]. It is soft over one pixel.
const int MOST = 8, SIDES = 10;
uniform int cubes;      // how many there are
uniform int longest;    // how many sides they have at most
uniform vec3 outlines[MOST * SIDES];

float seen() {
    vec3 here = vec3(gl_FragCoord.xy, 1.0);
    float share = 1.0;
    for (int cube = 0; cube < cubes; ++cube) {
        float inside = 1.0;
        for (int side = 0; side < longest; ++side)
            inside = min(inside, dot(outlines[cube * SIDES + side], here) + 0.5);
        share *= 1.0 - max(inside, 0.0);
    }
    return share;
}
