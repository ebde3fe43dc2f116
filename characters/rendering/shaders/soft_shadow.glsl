// The key light that reaches a point, by colour: percentage-closer soft shadows (R. Fernando, 2005). The penumbra of
// a lamp of width w is (dR - dB) w / dB wide, where the receiver is dR from the lamp and what blocks it dB.

#include "tile_offset"

uniform sampler2D blockers;     // distances of what blocks red, green and blue, see BlockerMap [m]
uniform mat4 lamp_from_point;
uniform vec4 lamp_area;         // lowest tangents of the map, and 1 / their range
uniform float lamp_width;       // [m]
uniform float nearest_blocker;  // distance from the lamp [m]
uniform vec2 shadow_range;      // so far behind a surface its shadow begins, and is complete [m]

const int SHADOW_TAPS = 4;      // along each side of the window
const int SEARCHES = 2;

// Place of a tap in the window, -0.5…0.5.
vec2 tap_at(int number, vec2 offset) {
    return (vec2(number % SHADOW_TAPS, number / SHADOW_TAPS) + offset) / float(SHADOW_TAPS) - 0.5;
}

vec3 blockers_at(vec2 tangents) {
    vec2 at = (tangents - lamp_area.xy) * lamp_area.zw;
    if (any(lessThan(at, vec2(0.0))) || any(greaterThanEqual(at, vec2(1.0)))) return vec3(1e3);
    return texelFetch(blockers, ivec2(at * vec2(textureSize(blockers, 0))), 0).rgb;
}

// Share of each colour that is blocked by what is at some distances, for a point at another.
vec3 blocking(vec3 distances, float receiver) {
    return clamp((receiver - distances) / (shadow_range.y - shadow_range.x), 0.0, 1.0);
}

vec3 key_left(vec3 point, ivec2 texel) {
    vec3 seen = (lamp_from_point * vec4(point, 1.0)).xyz;
    vec2 middle = seen.xy / seen.z;
    float receiver = seen.z - shadow_range.x;
    if (receiver <= nearest_blocker) return vec3(1.0);
    vec2 offset = tile_offset(texel);

    // The blockers are looked for again in the penumbra of those that were found: a foot on the table must not get
    // the soft edge of the head above it.
    float blocker = nearest_blocker;
    for (int search = 0; search < SEARCHES; ++search) {
        float window = lamp_width * (receiver - blocker) / (receiver * blocker);
        float sum = 0.0, count = 0.0;
        for (int i = 0; i < SHADOW_TAPS * SHADOW_TAPS; ++i) {
            vec3 distances = blockers_at(middle + window * tap_at(i, offset));
            vec3 share = blocking(distances, receiver);
            sum += dot(share, distances);
            count += dot(share, vec3(1.0));
        }
        if (count == 0.0) return vec3(1.0);
        if (count >= 3.0 * float(SHADOW_TAPS * SHADOW_TAPS)) return vec3(0.0);  // each tap blocks each colour
        blocker = sum / count;
    }

    float window = lamp_width * (receiver - blocker) / (receiver * blocker);
    vec3 left = vec3(1.0);
    for (int i = 0; i < SHADOW_TAPS * SHADOW_TAPS; ++i) {
        vec3 distances = blockers_at(middle + window * tap_at(i, offset));
        left -= blocking(distances, receiver) / float(SHADOW_TAPS * SHADOW_TAPS);
    }
    return left;
}
