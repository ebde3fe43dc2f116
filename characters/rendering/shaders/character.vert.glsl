#version 330 core

uniform mat4 clip_from_table;

in vec3 position;
in vec3 normal;
in vec3 color;
in vec2 uv;

out vec3 place;
out vec3 facing;
out vec3 tint;
#ifdef TEXTURED
out vec2 where;
#endif

void main() {
    place = position;
    facing = normal;
    tint = color;
#ifdef TEXTURED
    where = uv;
#endif
    gl_Position = clip_from_table * vec4(position, 1.0);
}
