// How much a texel counts for another, in a mean that does not cross edges: not if its depth is not that of the other's
// tangent plane there, and less if it faces elsewhere, or folds would be blurred with what is around them.

uniform sampler2D normal_id;
uniform sampler2D place;
uniform float focal;            // [texels]
uniform float tolerance;        // distance from the tangent plane at which a tap stops to count [m]

float surface_weight(vec3 normal, vec3 here, vec2 offset, ivec2 texel, float depth) {
    float plane = dot(normal, here);
    float from_plane = depth * (plane / here.z + dot(normal.xy, offset) / focal) - plane;
    float facing = max(dot(texelFetch(normal_id, texel, 0).xyz, normal), 0.0);
    facing *= facing;
    facing *= facing;
    return clamp(2.0 - 2.0 * abs(from_plane) / tolerance, 0.0, 1.0) * facing * facing;
}
