// What a surface scatters and, with MIRRORED, what it mirrors of the light of the room from all around.
// Directions and places are in the table frame. After "shading".

#include "room_light"

#ifdef MIRRORED
uniform sampler2D room_map;     // a square for each roughness, see reflections.py: square roots of linear light
uniform vec3 room_tiles[9];     // of a roughness of 0, 1/8 … 1: its side, and its first column and row
uniform vec4 room_sphere;       // centre and reach of the map

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
    vec3 tile = room_tiles[int(8.0 * clamp(rough, 0.0, 1.0) + 0.5)];
    vec2 at = tile.x * (0.5 + 0.5 * place) + tile.yz;
    vec3 root = textureLod(room_map, at / vec2(textureSize(room_map, 0)), 0.0).rgb;
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
// (Turquin, "Practical multiple scattering compensation for microfacet models", 2019).
vec3 reflected_of_room(vec3 albedo, float metal, float rough, float nv, vec3 around, vec3 seen) {
    vec2 shares = mirrored_shares(rough, clamp(nv, 0.0, 1.0));
    float again = 1.0 / (shares.x + shares.y) - 1.0;
    float matte = (0.04 * shares.x + shares.y) * (1.0 + 0.04 * again);
    vec3 polished = (albedo * shares.x + shares.y) * (1.0 + again * albedo);
    return mix(vec3(matte), polished, metal) * seen + (1.0 - metal) * (1.0 - matte) * albedo * around;
}
