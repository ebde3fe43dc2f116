#version 330 core

// One texel of the geometry buffer for each cell, which passes take that look far around.

#include "geometry_buffer"
#include "cells"

layout(location = 0) out vec4 pixel_normal_id;
layout(location = 1) out vec4 pixel_position;

void main() {
    ivec2 texel = texel_of(ivec2(gl_FragCoord.xy));
    pixel_normal_id = texelFetch(normal_id, texel, 0);
    pixel_position = texelFetch(position, texel, 0);
}
