#version 330 core

// One texel of the geometry buffer for each pixel, which passes take that look far around. Where no character is seen,
// its place is that of the table, which hides some light from them too.

#include "geometry_buffer"

uniform int fineness;           // texels for each pixel, along each side
uniform mat3 ray_from_pixel;    // ray of a place in the picture, in the camera frame
uniform vec3 plane;             // a point is on the table if its product with this is 1

layout(location = 0) out vec4 pixel_normal_id;
layout(location = 1) out vec4 pixel_position;

void main() {
    ivec2 texel = fineness * ivec2(gl_FragCoord.xy);
    pixel_normal_id = texelFetch(normal_id, texel, 0);
    pixel_position = texelFetch(position, texel, 0);
    if (is_seen(pixel_normal_id.w)) return;
    vec3 ray = ray_from_pixel * vec3(gl_FragCoord.xy, 1.0);
    float nearness = dot(plane, ray);
    pixel_position = nearness > 0.0 ? vec4(ray / nearness, 1.0) : vec4(0.0);
}
