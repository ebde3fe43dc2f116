#version 330 core

// Light that the character leaves on the table: no key light in its shadow, less ambient light near it.
// The factor multiplies linear light; a power of it multiplies the encoded picture the same way.

uniform sampler2D map;
uniform int side;       // columns of each half of the map
uniform vec3 key;       // share of the key light in the light on the table, by channel
uniform vec4 sky_occlusion; // share of the ambient light that each level can keep

out vec4 factor;

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    vec4 blocked = texelFetch(map, here, 0);
    vec4 closed = texelFetch(map, here + ivec2(side, 0), 0);
    float shade = min(dot(blocked, vec4(1.0)), 1.0);
    // It is dark under a foot, not black: foot and table reflect some light.
    float sky = min(dot(closed, sky_occlusion), 0.78);
    vec3 light = key * (1.0 - shade) + (1.0 - key) * (1.0 - sky);
    factor = vec4(pow(light, vec3(1.0 / 2.2)).bgr, 1.0);
}
