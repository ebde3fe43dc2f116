#version 330 core

// A key light with wrapped diffuse and a highlight, a hemisphere of sky and table, a rim.
// All sums are of linear light; the last lines encode to sRGB, blue first.

uniform vec3 eye;           // in the table frame
uniform vec3 to_light;
uniform vec3 key;           // linear RGB
uniform vec3 sky;
uniform vec3 ground;
uniform float height;       // of the character [m]
uniform vec3 base_color;
uniform float metallic;
uniform float roughness;
#ifdef TEXTURED
uniform sampler2D base_texture;
in vec2 where;
#endif

in vec3 place;
in vec3 facing;
in vec3 tint;

out vec4 color;

// Three roots are three times as fast as a power (I. Taylor, "sRGB approximations for HLSL", 2012).
vec3 encoded(vec3 light) {
    vec3 a = sqrt(light), b = sqrt(a), c = sqrt(b);
    return 0.662002687 * a + 0.684122060 * b - 0.323583601 * c - 0.0225411470 * light;
}

void main() {
    vec3 albedo = base_color * tint;
#ifdef TEXTURED
    albedo *= texture(base_texture, where).rgb;
#endif
    vec3 n = normalize(gl_FrontFacing ? facing : -facing);
    vec3 v = normalize(eye - place);
    vec3 h = normalize(v + to_light);
    float nl = dot(n, to_light), nv = max(dot(n, v), 0.0), nh = max(dot(n, h), 0.0);
    float vh = dot(v, h);

    // Skin, cloth and plastic let light round the corner: a wrap of a quarter.
    float wrapped = max((nl + 0.25) / 1.25, 0.0);
    float up = 0.5 + 0.5 * n.y;
    // Near the feet the character itself keeps light from the table, and the table from it.
    float near = clamp(place.y / (0.28 * height), 0.0, 1.0);
    near *= 2.0 - near;
    float open = mix(0.45 + 0.45 * up, 1.0, near);
    vec3 around = mix(ground * (0.55 + 0.45 * near), sky, up) * open;

    // GGX with the visibility term of B. Karis, "Optimizing PBR for mobile", 2015.
    float a = max(roughness * roughness, 0.02), a2 = a * a;
    float lobe = nh * nh * (a2 - 1.0) + 1.0;
    float highlight = a2 / (4.0 * lobe * lobe * max(vh * vh, 0.1) * (roughness + 0.5));
    vec3 f0 = mix(vec3(0.04), albedo, metallic);
    float grazing = 1.0 - nv;
    grazing *= grazing * grazing * grazing;
    vec3 mirror = f0 + (1.0 - f0) * grazing * (0.8 - 0.6 * roughness);

    vec3 light = albedo * (1.0 - metallic) * (key * wrapped + around)
               + key * f0 * min(highlight, 6.0) * clamp(nl * 4.0, 0.0, 1.0)
               + mirror * around;
    // A shoulder instead of a cliff where the light is strong.
    light *= 1.06 / (1.0 + 0.12 * light);
    color = vec4(clamp(encoded(light), 0.0, 1.0).bgr, 1.0);
}
