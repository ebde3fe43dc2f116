// The key light that reaches a point, by colour: percentage-closer soft shadows (R. Fernando, 2005). The penumbra of
// a lamp of width w is (dR - dB) w / dB wide, where the receiver is dR from the lamp and what blocks it dB.
// ON_SURFACE: for a point of a surface that is in the map itself.

#include "tile_offset"
#ifdef ON_SURFACE
#include "entries"
#endif

uniform sampler2D blockers;     // distances of what blocks red, green and blue, see BlockerMap [m]
uniform mat4 lamp_from_point;
uniform vec4 lamp_area;         // lowest tangents of the map, and 1 / their range
uniform float lamp_width;       // [m]
uniform float nearest_blocker;  // distance from the lamp [m]
uniform vec2 shadow_range;      // so far behind a surface its shadow begins, and is complete [m]
#ifdef ON_SURFACE
uniform float tile_m;           // size of a tile of cells, whose samples differ where a shadow is soft [m]
uniform vec2 surface_range;     // so high above a triangle an opaque surface begins to shadow it, and does so completely [m]
#endif

const int SHADOW_TAPS = 4;      // along each side of the window
const int SEARCHES = 2;
#ifdef ON_SURFACE
const float LEAST_WINDOW = 2.0; // [texels]: close up, the edge of a shadow must not show the map's texels
#else
const float LEAST_WINDOW = 0.0;
#endif

// Place of a tap in the window, -0.5…0.5.
vec2 tap_at(int number, vec2 offset) {
    return (vec2(number % SHADOW_TAPS, number / SHADOW_TAPS) + offset) / float(SHADOW_TAPS) - 0.5;
}

vec2 least_window;              // of which the taps are [tangents]

// Where a point is as the lamp sees it.
struct Receiver {
    vec2 middle;                // tangents
    float away;                 // distance along the lamp's axis, less what its own surface may be off [m]
#ifdef ON_SURFACE
    vec3 plane;                 // through its triangle: 1 / distance is the product with (tangents, 1); 0: not used
    float cosine;               // between its normal and the way to the lamp
#endif
};

// Distances of what blocks each colour at a tap so far from the middle, and the share of the colour that it blocks.
void block(Receiver receiver, vec2 offset, out vec3 distances, out vec3 share) {
    vec2 tangents = receiver.middle + offset, at = (tangents - lamp_area.xy) * lamp_area.zw;
    distances = vec3(1e3);
    share = vec3(0.0);
    if (any(lessThan(at, vec2(0.0))) || any(greaterThanEqual(at, vec2(1.0)))) return;
    vec2 side = vec2(textureSize(blockers, 0));
    ivec2 texel = ivec2(at * side);
    vec4 found = texelFetch(blockers, texel, 0);
    distances = found.rgb;
    share = clamp((receiver.away - distances) / (shadow_range.y - shadow_range.x), 0.0, 1.0);
#ifdef ON_SURFACE
    // What the light comes to first shadows a surface that it does not belong to. The surface is compared where the
    // texel has its distance, so that one which is steep to the lamp does not shadow itself.
    vec2 centre = lamp_area.xy + (vec2(texel) + 0.5) / (side * lamp_area.zw);
    float nearness = dot(receiver.plane, vec3(centre, 1.0));
    if (nearness <= 0.0) return;
    float entry = entry_distance(found.a);
    float away = receiver.away + shadow_range.x;
    float behind = min(1.0 / nearness, away) - entry;
    // The light of the lamp passes beside what is less high above the point than it is aside (G. Guennebaud et al.,
    // "Real-time soft shadow mapping by backprojection", 2006): a fold of the skin does not darken what is around it.
    vec2 aside = abs(offset) - 0.5 * max(vec2(lamp_width * (away - entry) / (away * entry)), least_window);
    if (max(aside.x, aside.y) > 0.0) return;
    vec3 opaque = vec3(clamp((behind * receiver.cosine - surface_range.x) / (surface_range.y - surface_range.x), 0.0, 1.0));
    distances = mix(distances, vec3(entry), greaterThan(opaque, share));
    share = max(share, opaque);
#endif
}

// `width` is that of the penumbra on the surface [m], or 0 without one.
vec3 key_left(Receiver receiver, ivec2 texel, out float width) {
    width = 0.0;
    if (receiver.away <= nearest_blocker) return vec3(1.0);
    vec2 offset = tile_offset(texel);
#ifdef ON_SURFACE
    vec2 search_offset = vec2(0.5);                     // sharp shadows are not smoothed: what is found must be even
#else
    vec2 search_offset = offset;
#endif
    least_window = LEAST_WINDOW / (lamp_area.zw * vec2(textureSize(blockers, 0)));

    // The blockers are looked for again in the penumbra of those that were found: a foot on the table must not get
    // the soft edge of the head above it.
    float blocker = nearest_blocker;
    vec3 distances, share;
    for (int search = 0; search < SEARCHES; ++search) {
        vec2 window = max(vec2(lamp_width * (receiver.away - blocker) / (receiver.away * blocker)), least_window);
        float sum = 0.0, count = 0.0;
        for (int i = 0; i < SHADOW_TAPS * SHADOW_TAPS; ++i) {
            vec2 tap = tap_at(i, search_offset);
#ifdef ON_SURFACE
            if (search == 0) tap *= 2.0 * abs(tap);     // what is near blocks close to the middle alone
#endif
            block(receiver, window * tap, distances, share);
            sum += dot(share, distances);
            count += dot(share, vec3(1.0));
        }
        if (count == 0.0) return vec3(1.0);
        if (count >= 3.0 * float(SHADOW_TAPS * SHADOW_TAPS)) return vec3(0.0);  // each tap blocks each colour
        blocker = sum / count;
    }

    vec2 window = vec2(lamp_width * (receiver.away - blocker) / (receiver.away * blocker));
    width = window.x * receiver.away;
    window = max(window, least_window);
#ifdef ON_SURFACE
    offset = mix(vec2(0.5), offset, min(width / tile_m, 1.0));
#endif
    vec3 left = vec3(1.0);
    for (int i = 0; i < SHADOW_TAPS * SHADOW_TAPS; ++i) {
        block(receiver, window * tap_at(i, offset), distances, share);
        left -= share / float(SHADOW_TAPS * SHADOW_TAPS);
    }
    return left;
}
