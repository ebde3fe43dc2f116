#version 330 core

// Diffuse light that spreads below the skin before it leaves again: a trilateral filter with Wendland's weights
// (Huang 2013, ch. 5.1, with a normalisation). It filters what falls on the skin, without the skin's own colours, so
// that freckles stay sharp. ADAPTIVE: fewer levels where ambient light arrives from everywhere (ch. 5.2).

#include "geometry_buffer"
#include "tile_offset"
#include "disc_taps"
#include "wendland"

const int LEVELS = 3;
const int TAPS = 12;                // of each level

uniform sampler2D diffuse;
uniform sampler2D ambient;          // with the share of it that arrives
uniform sampler2D falling;          // light that falls on skin, and 1; 0 elsewhere
uniform vec3 level_radius;          // of each level, for skin of scale 1 [m]
uniform float level_depth;          // difference in depth at which a level ends, as a share of its radius
uniform vec3 unscattered;           // share of the light that leaves where it enters, by colour
uniform mat3 level_share;           // share of each level, a column of three colours each
uniform float focal;                // [texels]
uniform vec2 open_limits;           // open share below which all levels count, and above which none does

layout(location = 0) out vec4 scattered;    // light of the skin, and the share of all taps that it took

vec3 filtered(ivec2 here, vec3 light, vec3 n, float depth, float radius) {
    float texels = radius * focal / depth;
    vec2 offset = tile_offset(here);
    vec3 sum = light;
    float total = 1.0;
    for (int i = 0; i < TAPS; ++i) {
        float away = disc_reach(i, TAPS, offset);
        ivec2 there = here + ivec2(round(away * texels * disc_direction(i, offset)));
        vec4 tap = texelFetch(falling, there, 0);
        float behind = abs(texelFetch(position, there, 0).z - depth) / (level_depth * radius);
        float weight = wendland(away) * wendland(behind) * tap.w
                     * max(dot(n, texelFetch(normal_id, there, 0).xyz), 0.0);
        sum += weight * tap.rgb;
        total += weight;
    }
    return sum / total;
}

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    vec4 n = texelFetch(normal_id, here, 0);
    if (!is_seen(n.w)) discard;
    vec4 light = texelFetch(falling, here, 0);
    scattered = vec4(texelFetch(diffuse, here, 0).rgb, 0.0);
    if (light.w < 0.5) return;      // not skin
    float scale = texelFetch(surfaces, ivec2(2, surface_row(n.w)), 0).x;
    float depth = texelFetch(position, here, 0).z;
    vec3 radius = scale * level_radius;
    float wide = 1.0, narrow = 1.0; // how far the wide levels, and the narrow one, replace the light itself
#ifdef ADAPTIVE
    float open = texelFetch(ambient, here, 0).a;
    float soft = 0.25 * (open_limits.y - open_limits.x);
    wide = 1.0 - smoothstep(open_limits.x - soft, open_limits.x + soft, open);
    narrow = 1.0 - smoothstep(open_limits.y - soft, open_limits.y + soft, open);
#endif
    vec3 level[LEVELS] = vec3[](light.rgb, light.rgb, light.rgb);
    if (narrow > 0.0) {
        level[0] = mix(light.rgb, filtered(here, light.rgb, n.xyz, depth, radius[0]), narrow);
        level[1] = level[2] = level[0];
        scattered.a += 1.0 / float(LEVELS);
    }
    if (wide > 0.0) {
        for (int i = 1; i < LEVELS; ++i)
            level[i] = mix(level[0], filtered(here, light.rgb, n.xyz, depth, radius[i]), wide);
        scattered.a += float(LEVELS - 1) / float(LEVELS);
    }
    vec3 sum = unscattered * light.rgb;
    for (int i = 0; i < LEVELS; ++i) sum += level_share[i] * level[i];
    vec4 albedo = texelFetch(albedo_rough, here, 0);
    scattered.rgb = sum * albedo.rgb;
}
