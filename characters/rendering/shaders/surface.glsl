// What a material says of a point: colours, roughness, metalness, and the normal with its bumps.

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
#endif
#ifdef GLOW
uniform vec3 glow;
#endif
#ifdef GLOW_MAP
uniform sampler2D glow_map;
#endif
#ifdef OCCLUSION
uniform sampler2D occlusion_map;    // share of the light from all around that arrives, in red
uniform float occlusion_strength;
#endif
#ifdef PLACED
in vec3 place;                  // in the table frame
#endif
#ifdef TOON
uniform vec3 shade_color;
#endif
#ifdef SHADE
uniform sampler2D shade_map;
#endif
#ifdef CUTOFF
uniform float opacity;
uniform float cutoff;
in float covering;
#endif

in vec3 facing;
in vec3 tint;
#ifdef FACE
#include "face"
vec3 face_texel;                // of face_map; set by surface_albedo, which comes first
#endif

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

#ifdef BLENDED
// Coverage of a point that is drawn later or casts a shadow: a mask shows that share of its texels.
float surface_alpha;

// Threshold, 0…1, that is even over a tile of 4 × 4 texels. Three layers behind each other cover independently:
// any two of the three orders are a net (every half, or quarter, of one has its share in the other).
uniform int screen_layer;       // of this surface, among those that are partly transparent

float screen_door() {
    const int ORDER[16] = int[](0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5);  // B. E. Bayer, 1973
    ivec2 at = ivec2(gl_FragCoord.xy) & 3;
    int order = ORDER[at.x + 4 * at.y], turned = 0;
    for (int bit = 0; bit < 4; ++bit) turned |= ((order >> bit) & 1) << (3 - bit);
    int kind = screen_layer % 3;
    int both = ((order ^ turned) & 12) | (order & 3);
    int found = kind == 0 ? order : kind == 1 ? turned : both;
    return (float(found) + 0.5) / 16.0;
}
#endif

vec3 surface_albedo() {
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
#ifdef BLENDED
    surface_alpha = alpha;
#else
    if (alpha < cutoff) discard;
#endif
#endif
#ifdef FACE
    face_texel = texture(face_map, where).xyz;
    albedo = flushed(albedo, face_texel.z);
#endif
    return albedo;
}

// Roughness and metalness.
vec2 surface_finish() {
    vec2 finish = vec2(roughness, metallic);
#ifdef SURFACE
    finish *= texture(surface_map, where).gb;
#endif
    return finish;
}

// Emitted light.
vec3 surface_glow() {
    vec3 emitted = vec3(0.0);
#ifdef GLOW
    emitted = glow;
#endif
#ifdef GLOW_MAP
    emitted *= texture(glow_map, where).rgb;
#endif
    return emitted;
}

// Share of the light from all around that arrives.
float surface_openness() {
#ifdef OCCLUSION
    return 1.0 - occlusion_strength * (1.0 - texture(occlusion_map, where).r);
#else
    return 1.0;
#endif
}

vec3 surface_normal() {
    vec3 n = normalize(facing);
#ifdef BUMPS
    n = bumped(n);
#endif
#ifdef FACE
    n = wrinkled(n, place, where, face_texel.xy);
#endif
    return gl_FrontFacing ? n : -n;
}

#ifdef TOON
// Colour of what the light does not reach.
vec3 surface_shade() {
    vec3 shade = shade_color;
#ifdef SHADE
    shade *= texture(shade_map, where).rgb;
#endif
#ifdef FACE
    shade = flushed(shade, face_texel.z);
#endif
    return shade;
}
#endif
