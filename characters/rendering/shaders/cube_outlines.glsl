#ifdef COVERED
#include "cover"
#endif

// Share of a pixel on the table that neither a real cube hides, being outside of all outlines, nor a hand.
// A side of an outline gives the distance inside of it [px]; the transition is one pixel wide.
const int MAX_CUBES = 8, MAX_SIDES = 10;
uniform int cube_count;      // number of outlines
uniform int longest;    // number of sides of the longest
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
#ifdef COVERED
    share *= 1.0 - covered(gl_FragCoord.xy);
#endif
    return share;
}
