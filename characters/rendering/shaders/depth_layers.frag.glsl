#version 330 core

// Depths of what is seen in each cell, before what is behind it is known.

#include "cells"

uniform sampler2D position;     // in the camera frame [m]; z is 0 where nothing is

out vec4 depths;                // end of what is seen, start and end of the next thing, start of what is seen [m]

void main() {
    const float NOTHING = 1e3;
    float depth = texelFetch(position, texel_of(ivec2(gl_FragCoord.xy)), 0).z;
    depths = vec4(vec3(NOTHING), depth > 0.0 ? depth : NOTHING);
}
