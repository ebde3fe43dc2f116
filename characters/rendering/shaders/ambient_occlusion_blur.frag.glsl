#version 330 core

// One direction of a mean over a tile, which does not cross edges: a tap counts if its depth is that of
// the pixel's tangent plane there, and less if it faces elsewhere, or folds would be blurred with what is
// around them. An even tile has one tap more, and its two ends count by half.

uniform sampler2D source;       // open share, depth
uniform sampler2D normal_id;
uniform sampler2D place;
uniform ivec2 direction;
uniform ivec2 size;             // of the picture [px]
uniform float focal;            // [px]
uniform bool last;              // limits the result: the tile is complete
uniform float tolerance;        // distance from the tangent plane at which a tap stops to count [m]

out vec2 open_depth;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    open_depth = texelFetch(source, pixel, 0).xy;
    vec4 surface = texelFetch(normal_id, pixel, 0);
    if (surface.w < 0.5)
        return;
    vec3 here = texelFetch(place, pixel, 0).xyz;
    float plane = dot(surface.xyz, here);
    float slope = dot(surface.xyz, vec3(vec2(direction), 0.0)) / focal;
    float total = 1e-6;         // so that a normal of no length does no harm
    float sum = total * open_depth.x;
    for (int i = -(TILE / 2); i <= TILE / 2; ++i) {
        ivec2 texel = clamp(pixel + i * direction, ivec2(0), size - 1);
        vec2 tap = texelFetch(source, texel, 0).xy;
        float from_plane = tap.y * (plane / here.z + float(i) * slope) - plane;
        float weight = clamp(2.0 - 2.0 * abs(from_plane) / tolerance, 0.0, 1.0);
        float facing = max(dot(texelFetch(normal_id, texel, 0).xyz, surface.xyz), 0.0);
        facing *= facing;
        facing *= facing;
        facing *= facing;
        weight *= facing * facing;
        if (TILE > 1 && TILE % 2 == 0 && abs(i) == TILE / 2)
            weight *= 0.5;
        sum += weight * tap.x;
        total += weight;
    }
    open_depth.x = last ? clamp(sum / total, 0.0, 1.0) : sum / total;
}
