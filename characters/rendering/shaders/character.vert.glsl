#version 330 core

uniform mat4 clip_from_table;
uniform vec3 eye;           // in the table frame
uniform float height;       // of the character [m]
#include "inside_cube"
#include "near_table"
#ifdef VERTEX_ROOM
#include "shading"
#include "room_light"
#endif

in vec3 position;
in vec3 normal;
in vec4 color;
in vec2 uv;

out vec3 toward;            // to the eye; stays a unit vector, since triangles are small
out float above;            // height above the ground, as a share of what counts as near it
out vec3 facing;
out vec3 tint;
#ifdef MAPPED
out vec2 where;
#endif
#ifdef PLACED
out vec3 place;             // in the table frame
#endif
#ifdef CUTOFF
out float covering;
#endif
#ifdef VERTEX_ROOM
out vec3 falling;           // light from all around: it changes little from vertex to vertex
#endif

void main() {
    toward = normalize(eye - position);
    above = position.y / (NEAR_TABLE * height);
    facing = normal;
    tint = color.rgb;
#ifdef MAPPED
    where = uv;
#endif
#ifdef PLACED
    place = position;
#endif
#ifdef CUTOFF
    covering = color.a;
#endif
#ifdef VERTEX_ROOM
    falling = light_of_room_near(normal, above);
#endif
    clip_to_cube(position);
    gl_Position = clip_from_table * vec4(position, 1.0);
}
