#version 330 core

// Lights what is seen in a texel, in three shares that later passes change apart.

#include "geometry_buffer"
#include "shading"
#include "near_table"
#ifdef ROOM
#include "room"
uniform mat4 table_from_camera;
#endif
#ifdef VISIBILITY
#include "visibility"
#endif
#ifdef OCCLUDED
uniform sampler2D occlusion;    // open share, see AmbientOcclusion
#endif

uniform vec3 up;            // normal of the table
uniform vec3 table;         // a point of the table

layout(location = 0) out vec4 diffuse;
layout(location = 1) out vec4 specular;
layout(location = 2) out vec4 ambient;  // and the share of the light from all around that arrives
layout(location = 3) out vec4 falling;  // light that falls on skin, and 1; 0 elsewhere

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    vec4 n = texelFetch(normal_id, here, 0);
    if (!is_seen(n.w)) discard;
    int surface = surface_row(n.w);
    vec4 toon = texelFetch(surfaces, ivec2(0, surface), 0);
    vec4 glow = texelFetch(glow_open, here, 0);
    vec4 point = texelFetch(position, here, 0);
    vec3 p = point.xyz;
    vec4 albedo = texelFetch(albedo_rough, here, 0);
    vec4 shade = texelFetch(shade_metal, here, 0);

    n.xyz = normalize(n.xyz);
    vec3 toward = normalize(-p);
    float rise = 0.5 + 0.5 * dot(n.xyz, up);
#ifdef OCCLUDED
    float above = 1.0;          // what is near the table is known better
#else
    float above = dot(p - table, up) / (NEAR_TABLE * texelFetch(surfaces, ivec2(1, surface), 0).y);
#endif
    Reflected light;
    if (toon.x > 0.5) {
#ifdef ROOM
        vec3 around = mix(light_of_room(mat3(table_from_camera) * n.xyz), irradiance[0], toon.w);
        around *= left_near_table(mix(rise, 0.5, toon.w), above);
#else
        vec3 around = light_around(mix(rise, 0.5, toon.w), above);
#endif
        light = reflected_by_toon(albedo.rgb, shade.rgb, toon.y, toon.z, n.xyz, around);
    } else {
#ifdef ROOM
        light = reflected(albedo.rgb, shade.w, albedo.w, n.xyz, toward, vec3(0.0));
        vec3 around = light_of_room_near(mat3(table_from_camera) * n.xyz, above), seen = around;
#ifdef MIRRORED
        vec3 way = mat3(table_from_camera) * reflect(-toward, n.xyz);
        vec3 mirrored = mirrored_room((table_from_camera * vec4(p, 1.0)).xyz, way, albedo.w);
        if (is_mirror(shade.w, albedo.w)) seen = mirrored * left_near_table(0.5 + 0.5 * way.y, above);
#endif
        light.ambient = reflected_of_room(albedo.rgb, shade.w, albedo.w, dot(n.xyz, toward), around, seen);
#else
        vec3 around = light_around(rise, above);
        light = reflected(albedo.rgb, shade.w, albedo.w, n.xyz, toward, around);
#endif
    }
    vec3 visible = vec3(1.0);
    float open = glow.a;
#ifdef VISIBILITY
    visible = visible_at(here, point);
#endif
#ifdef OCCLUDED
    open *= texelFetch(occlusion, here, 0).r;
#endif
    diffuse = vec4(visible * light.diffuse, 1.0);
    specular = vec4(visible * light.specular + glow.rgb, 1.0);
    ambient = open * vec4(light.ambient, 1.0);
    bool skin = toon.x < 0.5 && shade.r > 0.5;
    falling = skin ? vec4(visible * key * max(dot(n.xyz, to_light), 0.0), 1.0) : vec4(0.0);
#ifdef SCATTERED
    // Skin is not wrapped: what light does around the terminator is found by scattering it.
    if (skin) diffuse.rgb = falling.rgb * albedo.rgb;
#endif
}
