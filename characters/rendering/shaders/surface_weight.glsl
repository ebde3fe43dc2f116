// How much a texel counts for another, in a mean that does not cross edges: not if it is as far from the other's tangent
// plane as a cell is wide, or further than tolerated, and less if it faces elsewhere, or folds would be blurred with
// what is around them. After "cells".

uniform sampler2D normal_id;
uniform sampler2D place;
uniform float focal;            // [texels]
uniform float tolerance;        // [m]

float surface_weight(vec3 normal, vec3 here, vec2 offset, ivec2 texel, float depth) {
    float plane = dot(normal, here);
    float from_plane = depth * (plane / here.z + dot(normal.xy, offset) / focal) - plane;
    float facing = max(dot(texelFetch(normal_id, texel, 0).xyz, normal), 0.0);
    facing *= facing;
    facing *= facing;
    float limit = min(here.z * float(stride) / focal, tolerance);
    return clamp(2.0 - 2.0 * abs(from_plane) / limit, 0.0, 1.0) * facing * facing;
}
