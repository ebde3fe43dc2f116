#version 330 core

uniform mat4 clip_from_table;
uniform vec4 area;      // origin x, z and side of the square that the map covers
uniform vec4 extent;     // lowest x and z, highest x and z of the shadow

out vec2 at;

void main() {
    vec2 table = mix(extent.xy, extent.zw, vec2(gl_VertexID & 1, gl_VertexID >> 1));
    at = (table - area.xy) / area.z;
    gl_Position = clip_from_table * vec4(table.x, 0.0, table.y, 1.0);
}
