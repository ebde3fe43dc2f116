#version 330 core

// Diffuse light that spreads below the skin before it leaves again: a trilateral filter with Wendland's weights of the
// distance in space and the normals (Huang 2013, ch. 5.1, with a normalisation). It filters what falls on the skin,
// without the skin's own colours, so that freckles stay sharp. ADAPTIVE: left out where the light around does not
// bend, and sooner where ambient light arrives from everywhere (ch. 5.2). THROUGH: light that comes through ears and fingers.

#include "geometry_buffer"
#include "tile_offset"
#include "disc_taps"
#include "wendland"
#ifdef THROUGH
#include "light_through"
#endif

const int LEVELS = 3;
const int TAPS = 28;
const int PROBES = 4;

uniform sampler2D ambient;          // with the share of it that arrives
uniform sampler2D diffuse;
uniform sampler2D falling;          // light that falls on skin, and 1; 0 elsewhere
uniform vec3 level_radius;          // of each level, for skin of scale 1 [m]
uniform vec3 unscattered;           // share of the light that leaves where it enters, by colour
uniform mat3 level_share;           // share of each level, a column of three colours each
uniform float focal;                // [texels]
uniform vec2 open_limits;           // open shares of a fold, and of open skin
uniform vec2 bend_limits;         // how far light around bends, as a share of the key light, from which on it is filtered
uniform float probe_reach;          // how far around that is looked at, as a share of the widest level
uniform vec3 key;

layout(location = 0) out vec4 scattered;    // light of the skin, and the share of all taps that it took

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    vec4 n = texelFetch(normal_id, here, 0);
    if (!is_seen(n.w)) discard;
    vec4 light = texelFetch(falling, here, 0);
    scattered = vec4(texelFetch(diffuse, here, 0).rgb, 0.0);
    if (light.w < 0.5) return;      // not skin
    float scale = texelFetch(surfaces, ivec2(1, surface_row(n.w)), 0).x;
    vec3 point = texelFetch(position, here, 0).xyz;
    vec3 radius = scale * level_radius;
    float texels = radius[LEVELS - 1] * focal / point.z;
    vec2 offset = tile_offset(here);
    float filter_share = 1.0;
#ifdef ADAPTIVE
    float bent = 0.0;
    // Light that rises evenly is the same after it is spread: what counts is how it bends.
    int step = int(round(probe_reach * texels));
    for (int i = 0; i < PROBES / 2; ++i) {
        ivec2 along = i == 0 ? ivec2(step, 0) : ivec2(0, step);
        vec4 a = texelFetch(falling, here + along, 0), b = texelFetch(falling, here - along, 0);
        vec3 bend = abs(0.5 * (a.rgb + b.rgb) - light.rgb) * (a.w * b.w);
        bent = max(bent, max(bend.r, max(bend.g, bend.b)));
    }
    float strongest = max(max(key.r, key.g), max(key.b, 1e-4));
    // In folds, less is enough: light comes over their rims that the probes may miss.
    float open = smoothstep(open_limits.x, open_limits.y, texelFetch(ambient, here, 0).a);
    vec2 limits = bend_limits * mix(0.3, 1.0, open);
    filter_share = smoothstep(limits.x, limits.y, bent / strongest);
    scattered.a = float(PROBES) / float(TAPS);
#endif
    vec3 spread = light.rgb;
    if (filter_share > 0.0) {
        vec3 sum = vec3(0.0), total = vec3(1e-6);
        vec3 height = 1.0 / (radius * radius);  // of the levels, for volumes of 1 (times π / 7)
        for (int i = 0; i < TAPS; ++i) {
            // Half of all taps lie within a quarter of the widest level, and stand for rings that grow.
            float along = (float(i) + offset.y) / float(TAPS);
            float ring = along * along * along;
            ivec2 there = here + ivec2(round(along * along * texels * disc_direction(i, offset)));
            vec4 tap = texelFetch(falling, there, 0);
            float away = distance(texelFetch(position, there, 0).xyz, point);
            // What is nearer than the tap was meant to be is the same texel, or a fold of it.
            away = max(away, along * along * radius[LEVELS - 1]);
            vec3 level = height * vec3(wendland(away / radius.x), wendland(away / radius.y), wendland(away / radius.z));
            vec3 weight = ring * tap.w * max(dot(n.xyz, texelFetch(normal_id, there, 0).xyz), 0.0) * (level_share * level);
            sum += weight * tap.rgb;
            total += weight;
        }
        vec3 filtered = mix(sum / total, light.rgb, lessThan(total, vec3(1e-5 * height.z)));
        spread = mix(light.rgb, unscattered * light.rgb + (1.0 - unscattered) * filtered, filter_share);
        scattered.a += 1.0;
    }
#ifdef THROUGH
    spread += key * through(point, n.xyz, scale);
#endif
    scattered.a = min(scattered.a, 1.0);
    scattered.rgb = spread * texelFetch(albedo_rough, here, 0).rgb;
}
