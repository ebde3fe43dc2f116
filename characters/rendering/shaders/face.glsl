// What a face does beyond its shape: wrinkles (Huang 2013, section 4.3) and blood in the skin.
// face_map has the slope of the composed height along u and v, and where blood shows.

uniform sampler2D face_map;
uniform float wrinkle_depth;  // height of 1 in the table frame [m]
uniform vec3 blood_density;   // what blood adds to the optical density of skin, linear RGB

// Perturbs a normal by a height map without tangents, in screen space (M. Mikkelsen, "Bump mapping
// unparametrized surfaces on the GPU", 2010). The height's derivatives come from its slopes by the
// chain rule: differences of a magnified height would be constant within a block of texels.
vec3 wrinkled(vec3 n, vec3 place, vec2 where, vec2 slope) {
    vec3 across = dFdx(place), down = dFdy(place);
    vec3 along_x = cross(down, n), along_y = cross(n, across);
    float area = dot(across, along_x);
    vec3 rise = dot(slope, dFdx(where)) * along_x + dot(slope, dFdy(where)) * along_y;
    vec3 bent = abs(area) * n - sign(area) * wrinkle_depth * rise;
    float size = dot(bent, bent);
    bool kept = slope == vec2(0.0) || size <= 0.0;  // smooth skin stays exact; 0: seen from the edge
    return kept ? n : bent * inversesqrt(size);
}

// The colour of skin with more or less blood: pigments multiply what any skin reflects.
vec3 flushed(vec3 albedo, float share) {
    return share > 0.0 ? albedo * exp(-share * blood_density) : albedo;
}
