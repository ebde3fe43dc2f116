#version 330 core

// A point of a character, shaded. GEOMETRY: what it is like instead, for the passes that shade it later.

#include "surface"
#ifdef GEOMETRY
uniform mat4 camera_from_table;
uniform float surface_id;   // 1 for the first surface of the picture

layout(location = 0) out vec4 normal_id;    // unit normal in the camera frame, and the surface
layout(location = 1) out vec4 position;     // in the camera frame [m]
layout(location = 2) out vec4 albedo_rough; // linear RGB, and roughness
layout(location = 3) out vec4 shade_metal;  // colour of the toon shade, and metalness
#else
#include "shading"
#include "encoding"
#ifdef TOON
uniform float shade_shift;
uniform float toony;
uniform float evenness;
#endif
#ifdef GLOW
uniform vec3 glow;
#endif

in vec3 toward;
in float above;

out vec4 color;
#endif

void main() {
    vec3 albedo = surface_albedo();
    vec2 finish = surface_finish();
    vec3 n = surface_normal();
#ifdef GEOMETRY
    normal_id = vec4(mat3(camera_from_table) * n, surface_id);
    position = camera_from_table * vec4(place, 1.0);
    albedo_rough = vec4(albedo, finish.x);
#ifdef TOON
    shade_metal = vec4(surface_shade(), 0.0);
#else
    shade_metal = vec4(0.0, 0.0, 0.0, finish.y);
#endif
#else
    float up = 0.5 + 0.5 * n.y;
#ifdef TOON
    vec3 around = light_around(mix(up, 0.5, evenness), above);
    Reflected light = reflected_by_toon(albedo, surface_shade(), shade_shift, toony, n, around);
#else
    vec3 around = light_around(up, above);
    Reflected light = reflected(albedo, finish.y, finish.x, n, toward, around);
#endif
    vec3 sum = light.diffuse + light.specular + light.ambient;
#ifdef GLOW
    sum += glow;
#endif
    color = vec4(shown(sum), 1.0);
#endif
}
