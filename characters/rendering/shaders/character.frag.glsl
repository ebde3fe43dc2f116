#version 330 core

// A point of a character, shaded. GEOMETRY: what it is like instead, for the passes that shade it later.
// CASTER: its distance from the lamp instead, for the colours of light that it blocks.
// BEHIND: its depth instead, if it is behind what is known in its texel: the least of each number counts.

#include "surface"
#ifdef BEHIND
uniform mat4 camera_from_table;
uniform sampler2D known;    // depths: end of what is seen in x, its start in w
uniform bool is_next;       // whether the former is known

out vec4 behind;            // depths: end of what is seen, start and end of the next thing [m]

void main() {
    surface_albedo();       // holes
#ifdef BLENDED
    if (screen_door() >= surface_alpha) discard;
#endif
    const float NOTHING = 1e3, TOUCHING = 1e-5;
    vec4 limits = texelFetch(known, ivec2(gl_FragCoord.xy), 0);
    float depth = (camera_from_table * vec4(place, 1.0)).z;
    if (depth <= (is_next ? limits.x : limits.w) + TOUCHING) discard;
    behind = vec4(NOTHING);
    behind[gl_FrontFacing ? (is_next ? 1 : 3) : (is_next ? 2 : 0)] = depth;
}
#else
#ifdef CASTER
#include "entries"
uniform vec4 lamp_axis;     // of the table frame: distance from the lamp
uniform bool two_sided;

out vec4 blocked;           // nearest distance for red, green and blue [m], and where light comes to a surface

void main() {
    vec3 albedo = surface_albedo();
    float away = dot(lamp_axis, vec4(place, 1.0));
    vec3 blocking = vec3(1.0);
#ifdef BLENDED
    // The covered share filters the light; of an opaque surface, nothing passes.
    vec3 passing = (1.0 - surface_alpha) + min(surface_alpha, 1.0 - surface_alpha) * albedo;
    blocking = vec3(lessThan(vec3(screen_door()), 1.0 - passing));
#endif
    // Faces that look away from the lamp block it: what it lights does not shadow itself.
    bool skin = false;
#ifdef SKIN
    skin = any(notEqual(where, vec2(0.0)));
#endif
    blocked = vec4(mix(vec3(1e3), vec3(away), blocking), 1e9);
    // Light that glass lets through has not come to a surface.
    if (gl_FrontFacing && blocking == vec3(1.0)) blocked.a = entry_of(away, skin);
    if (gl_FrontFacing && !two_sided) blocked.rgb = vec3(1e3);
}
#else
#ifdef GEOMETRY
#include "flat_normal"
uniform mat4 camera_from_table;
uniform float surface_id;   // 1 for the first surface of the picture

layout(location = 0) out vec4 normal_id;    // unit normal in the camera frame, and the surface
layout(location = 1) out vec4 position;     // in the camera frame [m], and the packed normal of the triangle
layout(location = 2) out vec4 albedo_rough; // linear RGB, and roughness
layout(location = 3) out vec4 shade_metal;  // colour of the toon shade, or whether this is skin, and metalness
layout(location = 4) out vec4 glow_open;    // emitted light, and the share of that from all around that arrives
#else
#include "shading"
#include "encoding"
#ifdef ROOM
#include "room"
#endif
#ifdef TOON
uniform float shade_shift;
uniform float toony;
uniform float evenness;
#endif

in vec3 toward;
in float above;
#ifdef VERTEX_ROOM
in vec3 falling;            // light from all around
#endif

out vec4 color;
#endif

void main() {
    vec3 albedo = surface_albedo();
#if defined(GEOMETRY) && defined(BLENDED)
    if (screen_door() >= surface_alpha) discard;
#endif
    vec2 finish = surface_finish();
    vec3 n = surface_normal();
#ifdef GEOMETRY
    normal_id = vec4(mat3(camera_from_table) * n, surface_id);
    position = camera_from_table * vec4(place, 1.0);
    vec3 flat_normal = cross(dFdy(position.xyz), dFdx(position.xyz));
    position.w = number_of_normal(flat_normal * inversesqrt(max(dot(flat_normal, flat_normal), 1e-30)));
    albedo_rough = vec4(albedo, finish.x);
    glow_open = vec4(surface_glow(), surface_openness());
#ifdef TOON
    shade_metal = vec4(surface_shade(), 0.0);
#else
    shade_metal = vec4(0.0, 0.0, 0.0, finish.y);
#ifdef SKIN
    shade_metal.r = float(any(notEqual(where, vec2(0.0))));  // parts without texture coordinates are not skin
#endif
#endif
#else
    float up = 0.5 + 0.5 * n.y;
#ifdef TOON
#ifdef ROOM
    vec3 around = mix(light_of_room(n), irradiance[0], evenness) * left_near_table(mix(up, 0.5, evenness), above);
#else
    vec3 around = light_around(mix(up, 0.5, evenness), above);
#endif
    Reflected light = reflected_by_toon(albedo, surface_shade(), shade_shift, toony, n, around);
#else
#ifdef ROOM
    Reflected light = reflected(albedo, finish.y, finish.x, n, toward, vec3(0.0));
#ifdef VERTEX_ROOM
    vec3 around = falling, seen = around;
#else
    vec3 around = light_of_room_near(n, above), seen = around;
#endif
#ifdef MIRRORED
    vec3 way = reflect(-toward, n);
    seen = mirrored_room(place, way, finish.x) * left_near_table(0.5 + 0.5 * way.y, above);
#endif
    light.ambient = reflected_of_room(albedo, finish.y, finish.x, dot(n, toward), around, seen);
#else
    vec3 around = light_around(up, above);
    Reflected light = reflected(albedo, finish.y, finish.x, n, toward, around);
#endif
#endif
#ifdef OCCLUSION
    light.ambient *= surface_openness();
#endif
    vec3 sum = light.diffuse + light.specular + light.ambient;
#ifdef GLOW
    sum += surface_glow();
#endif
    color = vec4(shown(sum), 1.0);
#endif
}
#endif
#endif
