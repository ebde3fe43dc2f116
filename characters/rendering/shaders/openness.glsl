// Share of the light from all around that reaches a texel, from one value for each pixel; those whose depth is another
// do not count.

uniform sampler2D occlusion;    // open share and depth [m], see AmbientOcclusion
uniform int fineness;           // texels for each pixel, along each side
uniform ivec2 last_pixel;
uniform float depth_tolerance;  // [m]

float open_share(ivec2 texel, float depth) {
    vec2 at = (vec2(texel) + 0.5) / float(fineness) - 0.5;
    ivec2 corner = ivec2(floor(at));
    vec2 part = at - vec2(corner);
    float sum = 0.0, total = 0.0;
    for (int i = 0; i < 4; ++i) {
        ivec2 step = ivec2(i & 1, i >> 1);
        vec2 near = texelFetch(occlusion, clamp(corner + step, ivec2(0), last_pixel), 0).rg;
        vec2 share = mix(1.0 - part, part, vec2(step));
        float weight = max(share.x * share.y, 1e-3) * max(1.0 - abs(near.y - depth) / depth_tolerance, 1e-4);
        sum += weight * near.x;
        total += weight;
    }
    return sum / total;
}
