#version 330 core

// A vertex of a character, shaded: where triangles are as small as pixels, all between looks the same.

uniform mat4 clip_from_table;
uniform vec3 eye;           // in the table frame
uniform float height;       // of the character [m]
uniform vec3 base_color;
uniform float metallic;
uniform float roughness;
#ifdef GLOW
uniform vec3 glow;
#endif
#include "inside_cube"
#include "near_table"
#include "shading"
#include "encoding"
#ifdef ROOM
#include "room"
#endif

in vec3 position;
in vec3 normal;
in vec4 color;

out vec3 shade;             // as the picture shows it

void main() {
    vec3 albedo = base_color * color.rgb, toward = normalize(eye - position);
    float above = position.y / (NEAR_TABLE * height);
#ifdef ROOM
    Reflected light = reflected(albedo, metallic, roughness, normal, toward, vec3(0.0));
    vec3 around = light_of_room_near(normal, above);
    light.ambient = reflected_of_room(albedo, metallic, roughness, dot(normal, toward), around, around);
#else
    vec3 around = light_around(0.5 + 0.5 * normal.y, above);
    Reflected light = reflected(albedo, metallic, roughness, normal, toward, around);
#endif
    vec3 sum = light.diffuse + light.specular + light.ambient;
#ifdef GLOW
    sum += glow;
#endif
    shade = shown(sum);
    clip_to_cube(position);
    gl_Position = clip_from_table * vec4(position, 1.0);
}
