#version 330 core

// A rectangle of the layer on a plane.

uniform vec4 clip_area;     // lowest x and y, highest x and y in clip space
uniform vec3 depth;         // of the plane, by x and y in clip space and 1

void main() {
    vec2 at = mix(clip_area.xy, clip_area.zw, vec2(gl_VertexID & 1, gl_VertexID >> 1));
    gl_Position = vec4(at, dot(depth, vec3(at, 1.0)), 1.0);
}
