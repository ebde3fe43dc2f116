// The light of the room from all around: what a surface scatters of it, and with MIRRORED what it mirrors.
// Directions and places are in the table frame. After "shading".

uniform vec3 irradiance[9];     // coefficients of harmonics, see cube_map.py

// Light on a surface that is turned to n, with nothing near it.
vec3 light_of_room(vec3 n) {
    vec3 sum = irradiance[0] + n.y * irradiance[1] + n.z * irradiance[2] + n.x * irradiance[3];
    sum += n.x * n.y * irradiance[4] + n.y * n.z * irradiance[5] + n.x * n.z * irradiance[7];
    sum += (3.0 * n.z * n.z - 1.0) * irradiance[6] + (n.x * n.x - n.y * n.y) * irradiance[8];
    return max(sum, 0.0);       // of few harmonics, a bright lamp is negative behind
}

// What is left of light from a side, near the table: see light_around.
float left_near_table(float up, float above) {
    float near = near_table(above);
    return mix(0.55 + 0.45 * near, 1.0, up) * openness(up, near);
}

vec3 light_of_room_near(vec3 n, float above) {
    return light_of_room(n) * left_near_table(0.5 + 0.5 * n.y, above);
}

#ifdef MIRRORED
uniform sampler2D room_map;     // a square for each roughness, see reflections.py: square roots of linear light
uniform vec2 room_tiles[5];     // its side and its first row
uniform vec4 room_sphere;       // centre and reach of the map

vec3 room_tile(vec2 place, int tile) {
    vec2 at = room_tiles[tile].x * (0.5 + 0.5 * place) + vec2(1.0, room_tiles[tile].y);
    return textureLod(room_map, at / vec2(textureSize(room_map, 0)), 0.0).rgb;
}

// Light from a side of a place, as a surface of some roughness mirrors it: from where the way meets the table
// or the sphere around it, as the centre of the map sees it.
vec3 mirrored_room(vec3 p, vec3 way, float rough) {
    vec3 off = p - room_sphere.xyz;
    float along = dot(off, way);
    float far = sqrt(max(along * along + room_sphere.w * room_sphere.w - dot(off, off), 0.0)) - along;
    float table = max(p.y, 0.0) / max(-way.y, 1e-4);
    vec3 seen = off + min(far, table) * way;
    seen /= abs(seen.x) + abs(seen.y) + abs(seen.z);
    vec2 place = seen.xz;
    if (seen.y < 0.0) place -= seen.y * vec2(seen.x < 0.0 ? -1.0 : 1.0, seen.z < 0.0 ? -1.0 : 1.0);
    float level = 4.0 * clamp(rough, 0.0, 1.0);
    int first = min(int(level), 3);
    vec3 root = mix(room_tile(place, first), room_tile(place, first + 1), level - float(first));
    return root * root;
}
#endif

// Whether a surface mirrors more than the mean of what is around, see mirrors in surfaces.py.
bool is_mirror(float metal, float rough) {
    return metal >= 0.2 || rough < 0.45;
}

// Share of light from all around that a surface mirrors: what 0 and 1 of the Fresnel reflectance at right angles
// count (Karis, "Physically based shading on mobile", 2014).
vec2 mirrored_shares(float rough, float nv) {
    vec4 r = rough * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
    float edge = min(r.x * r.x, exp2(-9.28 * nv)) * r.x + r.y;
    return vec2(-1.04, 1.04) * edge + r.zw;
}

// What leaves a point of light from all around: `around` falls on it, and `seen` is what it mirrors. Light that a
// rough surface mirrors more than once is not lost, so that a white one is as bright as white light around it
// (Fdez-Agüera, "A multiple-scattering microfacet model for real-time image-based lighting", JCGT 2019).
vec3 reflected_of_room(vec3 albedo, float metal, float rough, float nv, vec3 around, vec3 seen) {
    vec2 shares = mirrored_shares(rough, clamp(nv, 0.0, 1.0));
    float again = 1.0 - shares.x - shares.y;
    const float F0 = 0.04, MEAN = F0 + (1.0 - F0) / 21.0;
    float once_matte = F0 * shares.x + shares.y;
    float more_matte = again * once_matte * MEAN / (1.0 - again * MEAN);
    vec3 mean = albedo + (1.0 - albedo) / 21.0;
    vec3 once_metal = albedo * shares.x + shares.y;
    vec3 more_metal = again * once_metal * mean / (1.0 - again * mean);
    vec3 matte = albedo * (1.0 - once_matte - more_matte) + more_matte;
    return mix(vec3(once_matte), once_metal + more_metal, metal) * seen + (1.0 - metal) * matte * around;
}
