#version 330 core

// A rectangle of the layer, at one depth.

uniform vec4 clip_area;     // lowest x and y, highest x and y in clip space
uniform float depth;

void main() {
    vec2 at = mix(clip_area.xy, clip_area.zw, vec2(gl_VertexID & 1, gl_VertexID >> 1));
    gl_Position = vec4(at, depth, 1.0);
}
