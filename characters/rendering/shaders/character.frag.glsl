#version 330 core

// A key light with wrapped diffuse and specular, hemispheric ambient light, a Fresnel rim.
// All sums are of linear light; the last lines encode to sRGB, in BGR order.

uniform vec3 to_light;      // in the table frame
uniform vec3 key;           // linear RGB
uniform vec3 sky;
uniform vec3 ground;
uniform vec3 base_color;
uniform float metallic;
uniform float roughness;
#ifdef MAPPED
in vec2 where;
#endif
#ifdef TEXTURED
uniform sampler2D base_texture;
#endif
#ifdef SURFACE
uniform sampler2D surface_map;  // roughness in green, metalness in blue
#endif
#ifdef BUMPS
uniform sampler2D bump_map;     // normals in tangent space
uniform float bump_scale;
in vec3 place;
#endif
#ifdef GLOW
uniform vec3 glow;
#endif
#ifdef TOON
uniform vec3 shade_color;
uniform float shade_shift;
uniform float toony;
uniform float evenness;
#endif
#ifdef SHADE
uniform sampler2D shade_map;
#endif
#ifdef CUTOFF
uniform float opacity;
uniform float cutoff;
in float covering;
#endif

in vec3 toward;
in float above;
in vec3 facing;
in vec3 tint;

out vec4 color;

// Two roots are several times as fast as a power; fitted to sRGB over 0.004…1.1, error below 0.2 of 255.
vec3 encoded(vec3 light) {
    vec3 a = sqrt(light), b = sqrt(a);
    return 0.82443678 * a + 0.30650353 * b - 0.05245525 * light - 0.07884886;
}

#ifdef BUMPS
// Perturbs a normal by the normal map. The tangents are the derivatives of position and texture
// coordinates on screen, so the mesh needs none (C. Schüler, "Normal mapping without precomputed tangents",
// ShaderX5, 2006); mirrored and stretched coordinates work too. Green is up, which is along -v.
vec3 bumped(vec3 n) {
    vec3 lean = texture(bump_map, where).xyz * 2.0 - 1.0;
    vec3 across = dFdx(place), down = dFdy(place);
    vec2 u = dFdx(where), v = dFdy(where);
    float area = u.x * v.y - u.y * v.x;
    if (abs(area) < 1e-13) return n;  // the texture is a single point here
    float turned = sign(area);
    vec3 along_u = turned * (across * v.y - down * u.y);
    vec3 along_v = turned * (down * u.x - across * v.x);
    along_u -= n * dot(n, along_u);
    along_v -= n * dot(n, along_v);
    float size = inversesqrt(max(dot(along_u, along_u), dot(along_v, along_v)));
    lean.xy *= bump_scale * size;
    return normalize(lean.x * along_u - lean.y * along_v + lean.z * n);
}
#endif

void main() {
#ifdef TOON
    vec3 albedo = base_color;  // MToon ignores colours of vertices
#else
    vec3 albedo = base_color * tint;
#endif
#ifdef TEXTURED
    vec4 painted = texture(base_texture, where);
    albedo *= painted.rgb;
#endif
#ifdef CUTOFF
    float alpha = opacity * covering;
#ifdef TEXTURED
    // Smaller mipmaps mix holes and hair, which would thin hair out with distance: alpha grows with the level.
    vec2 a_column = dFdx(where) * vec2(textureSize(base_texture, 0));
    vec2 a_row = dFdy(where) * vec2(textureSize(base_texture, 0));
    float level = 0.5 * log2(max(max(dot(a_column, a_column), dot(a_row, a_row)), 1.0));
    alpha *= painted.a * (1.0 + 0.25 * level);
#endif
    if (alpha < cutoff) discard;
#endif
    float metal = metallic, rough = roughness;
#ifdef SURFACE
    vec2 surface = texture(surface_map, where).gb;
    rough *= surface.x;
    metal *= surface.y;
#endif
    vec3 n = normalize(facing);
#ifdef BUMPS
    n = bumped(n);
#endif
    n = gl_FrontFacing ? n : -n;
    float nl = dot(n, to_light), nv = dot(n, toward);
    float vl = dot(toward, to_light);

    // Skin, cloth and plastic scatter light around the terminator: a wrap of a quarter.
    float wrapped = max((nl + 0.25) / 1.25, 0.0);
    float up = 0.5 + 0.5 * n.y;
#ifdef TOON
    up = mix(up, 0.5, evenness);
#endif
    // Near the feet, the character occludes the table, and the table the character.
    float near = clamp(above, 0.0, 1.0);
    near *= 2.0 - near;
    float open = mix(0.45 + 0.45 * up, 1.0, near);
    vec3 around = mix(ground * (0.55 + 0.45 * near), sky, up) * open;

#ifdef TOON
    // The specification VRMC_materials_mtoon 1.0, "Lighting" and "Global Illumination".
    vec3 shade = shade_color;
#ifdef SHADE
    shade *= texture(shade_map, where).rgb;
#endif
    float lit = clamp((nl + shade_shift + 1.0 - toony) / max(2.0 - 2.0 * toony, 1e-3), 0.0, 1.0);
    vec3 light = mix(shade, albedo, lit) * key + albedo * around;
#else
    // GGX with the visibility term of B. Karis, "Optimizing PBR for mobile", 2015. The half vector is
    // h = (v + l) / |v + l| and (v·h)² = |v + l|² / 4, which leaves one division and no root.
    float a = max(rough * rough, 0.02), a2 = a * a;
    float sum2 = max(2.0 + 2.0 * vl, 1e-3), nsum = max(nl + nv, 0.0);
    float lobe = nsum * nsum * (a2 - 1.0) + sum2;
    float highlight = a2 * sum2 * sum2 / (lobe * lobe * max(sum2, 0.4) * (rough + 0.5));
    vec3 f0 = mix(vec3(0.04), albedo, metal);
    float grazing = 1.0 - clamp(nv, 0.0, 1.0);
    grazing *= grazing * grazing * grazing;
    vec3 mirror = f0 + (1.0 - f0) * grazing * (0.8 - 0.6 * rough);

    vec3 light = albedo * (1.0 - metal) * (key * wrapped + around)
               + key * f0 * min(highlight, 6.0) * clamp(nl * 4.0, 0.0, 1.0)
               + mirror * around;
#endif
#ifdef GLOW
    light += glow;
#endif
    // Soft shoulder for strong light instead of clipping.
    light *= 1.06 / (1.0 + 0.12 * light);
    color = vec4(clamp(encoded(light), 0.0, 1.0).bgr, 1.0);
}
