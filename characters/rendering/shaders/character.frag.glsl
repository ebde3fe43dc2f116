#version 330 core

// A key light with wrapped diffuse and a GGX highlight, a hemisphere of sky and table, a rim.
// All sums are of linear light; the last line encodes to sRGB, blue first.

uniform vec3 eye;           // in the table frame
uniform vec3 to_light;
uniform vec3 key;           // linear RGB
uniform vec3 sky;
uniform vec3 ground;
uniform float height;       // of the character [m]
uniform vec3 base_color;
uniform float metallic;
uniform float roughness;
uniform bool textured;
uniform sampler2D base_texture;

in vec3 place;
in vec3 facing;
in vec4 tint;
in vec2 where;

out vec4 color;

vec3 encoded(vec3 light) {
    vec3 low = 12.92 * light, high = 1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055;
    return mix(high, low, lessThan(light, vec3(0.0031308)));
}

void main() {
    vec3 albedo = base_color * tint.rgb;
    if (textured) albedo *= texture(base_texture, where).rgb;
    vec3 n = normalize(gl_FrontFacing ? facing : -facing);
    vec3 v = normalize(eye - place);
    vec3 h = normalize(v + to_light);
    float nl = dot(n, to_light), nv = max(dot(n, v), 1e-3), nh = max(dot(n, h), 0.0);

    // Skin, cloth and plastic let light round the corner: Valve's wrap, a quarter of the way.
    float wrapped = max((nl + 0.25) / 1.25, 0.0);
    float up = 0.5 + 0.5 * n.y;
    // The table takes the light from below away near the feet.
    float near = smoothstep(0.0, 0.28, place.y / height);
    float open = mix(mix(0.45, 0.9, up), 1.0, near);
    vec3 ambient = mix(ground * mix(0.55, 1.0, near), sky, up) * open;

    float a = max(roughness * roughness, 0.02), a2 = a * a;
    float lobe = nh * nh * (a2 - 1.0) + 1.0;
    float highlight = min(a2 / (4.0 * lobe * lobe * max(dot(v, h) * dot(v, h), 0.1) * (roughness + 0.5)), 6.0);
    vec3 f0 = mix(vec3(0.04), albedo, metallic);
    float grazing = pow(1.0 - nv, 5.0);
    vec3 mirror = f0 + (1.0 - f0) * grazing * (1.0 - 0.75 * roughness);

    vec3 light = albedo * (1.0 - metallic) * (key * wrapped + ambient);
    light += key * f0 * highlight * clamp(nl * 4.0, 0.0, 1.0);
    light += mirror * mix(ground, sky, up) * open * 0.6;
    // A shoulder instead of a cliff where the light is strong.
    light = light / (1.0 + 0.12 * light * light);
    color = vec4(encoded(clamp(light, 0.0, 1.0)).bgr, 1.0);
}
