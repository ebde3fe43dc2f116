// The share of the lamp's light that comes through thin skin from behind, by colour. The way through is that between
// where the map of the lamp sees the light go in and the point (J. Jimenez et al., "Real-time realistic skin translucency", 2010).

#include "entries"

uniform sampler2D blockers;     // see BlockerMap
uniform mat4 lamp_from_point;
uniform vec4 lamp_area;         // lowest tangents of the map, and 1 / their range
uniform vec3 to_light;
uniform vec3 thin_share;        // share of the light that comes through thin skin
uniform vec3 through_length;    // way after which 1 / e of it is left, in skin of scale 1 [m]

const float LEAST_WAY = 1e-3;   // in skin of scale 1: no ear is thinner [m]

const float STEEP = 0.15;       // cosine

vec3 through(vec3 point, vec3 n, float scale) {
    // On the other side, whose normal is not known. Where it is steep to the lamp, the way in a texel of the map is not
    // that of the point.
    float falls = max(-dot(n, to_light) - STEEP, 0.0) / (1.0 - STEEP);
    if (falls == 0.0) return vec3(0.0);
    vec3 seen = (lamp_from_point * vec4(point, 1.0)).xyz;
    vec2 at = (seen.xy / seen.z - lamp_area.xy) * lamp_area.zw * vec2(textureSize(blockers, 0)) - 0.5;
    ivec2 corner = ivec2(floor(at));
    vec2 part = at - vec2(corner);
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 4; ++i) {
        ivec2 step = ivec2(i & 1, i >> 1);
        vec2 share = mix(1.0 - part, part, vec2(step));
        float entry = texelFetch(blockers, clamp(corner + step, ivec2(0), textureSize(blockers, 0) - 1), 0).a;
        float way = (seen.z - entry_distance(entry)) / scale;
        // Clothes and hair let nothing through, and what the light comes to behind the point is something else.
        if (!enters_skin(entry) || way < 0.0) continue;
        sum += share.x * share.y * exp(-max(way, LEAST_WAY) / through_length);
    }
    return falls * thin_share * sum;
}
