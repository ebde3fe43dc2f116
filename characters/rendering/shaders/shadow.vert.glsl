#version 330 core

uniform mat4 clip_from_table;
uniform vec4 area;      // origin x, z and side of the square

out vec2 at;

void main() {
    at = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    vec2 table = area.xy + at * area.z;
    gl_Position = clip_from_table * vec4(table.x, 0.0, table.y, 1.0);
}
