#version 330 core

// Leaves of a supersampled, premultiplied layer what the hand does not cover.

uniform float fineness;     // texels of the layer for each pixel, along each side

out vec4 color;

#include "cover"

void main() {
    color = vec4(0.0, 0.0, 0.0, covered(gl_FragCoord.xy / fineness));
}
