// How light falls on a surface: a key light with wrapped diffuse and specular, hemispheric ambient light,
// a Fresnel rim. All is linear light. Directions are in any one frame.

uniform vec3 to_light;      // unit vector
uniform vec3 key;           // linear RGB
uniform vec3 sky;
uniform vec3 ground;

// The light that leaves a point, by the way that it took.
struct Reflected {
    vec3 diffuse;           // of the key light
    vec3 specular;          // of the key light
    vec3 ambient;           // of the light from all around
};

// Light from all around on a surface that is turned upwards by `up`, 0…1. Near the feet, the character occludes
// the table, and the table the character: `above` is the height over it, as a share of what counts as near.
float near_table(float above) {
    float near = clamp(above, 0.0, 1.0);
    return near * (2.0 - near);
}

float openness(float up, float near) {
    return mix(0.45 + 0.45 * up, 1.0, near);
}

vec3 light_around(float up, float above) {
    float near = near_table(above);
    return mix(ground * (0.55 + 0.45 * near), sky, up) * openness(up, near);
}

// Skin, cloth and plastic scatter light around the terminator: a wrap of a quarter.
float wrapped(float nl) {
    return max((nl + 0.25) / 1.25, 0.0);
}

// GGX with the visibility term of B. Karis, "Optimizing PBR for mobile", 2015. The half vector is
// h = (v + l) / |v + l| and (v·h)² = |v + l|² / 4, which leaves one division and no root.
Reflected reflected(vec3 albedo, float metal, float rough, vec3 n, vec3 toward, vec3 around) {
    float nl = dot(n, to_light), nv = dot(n, toward);
    float vl = dot(toward, to_light);
    float a = max(rough * rough, 0.02), a2 = a * a;
    float sum2 = max(2.0 + 2.0 * vl, 1e-3), nsum = max(nl + nv, 0.0);
    float lobe = nsum * nsum * (a2 - 1.0) + sum2;
    float highlight = a2 * sum2 * sum2 / (lobe * lobe * max(sum2, 0.4) * (rough + 0.5));
    vec3 f0 = mix(vec3(0.04), albedo, metal);
    float grazing = 1.0 - clamp(nv, 0.0, 1.0);
    grazing *= grazing * grazing * grazing;
    vec3 mirror = f0 + (1.0 - f0) * grazing * (0.8 - 0.6 * rough);
    vec3 matte = albedo * (1.0 - metal);
    return Reflected(
        matte * key * wrapped(nl),
        key * f0 * min(highlight, 6.0) * clamp(nl * 4.0, 0.0, 1.0),
        (matte + mirror) * around);
}

// The specification VRMC_materials_mtoon 1.0, "Lighting" and "Global Illumination".
Reflected reflected_by_toon(vec3 albedo, vec3 shade, float shift, float toony, vec3 n, vec3 around) {
    float nl = dot(n, to_light);
    float lit = clamp((nl + shift + 1.0 - toony) / max(2.0 - 2.0 * toony, 1e-3), 0.0, 1.0);
    return Reflected(mix(shade, albedo, lit) * key, vec3(0.0), albedo * around);
}
