// Ambient occlusion in the picture's plane (Huang 2013, ch. 3): LINES lines of SAMPLES samples through
// each pixel, the pixel itself among them. The estimator that includes this file says what they mean.

#include "wendland"

const float PI = 3.14159265;
const float FAR_BEHIND = 4.0;   // where the background is taken to be [radii]
const float NOTHING = 1e3;      // depth at which there is nothing [m]

uniform sampler2D normal_id;    // unit normal in the camera frame, and ID in w: below 0.5 is background
uniform sampler2D place;        // position in the camera frame [m]; z is 0 in the background
uniform sampler2D pattern;      // of the tile: turn of the lines, shift of their samples, both 0…1
uniform ivec2 size;             // of the picture [px]
uniform vec3 ground;            // a point is on the plane where nothing else is if its product with this is 1
uniform float radius;           // occluders farther away do not count [m]
uniform float focal;            // focal length [px]
uniform float crowding;         // 0: samples are spread evenly along a line, 1: they crowd at the pixel
uniform float by_area;          // 0: every sample counts the same, 1: by the area that it stands for
uniform float bias;             // sine of the elevation above the surface from which on samples count
uniform float fill;             // where a rise of the horizon is: 0 at the sample that made it, 1 at the last
uniform float darkness;         // gain of the occlusion

out vec2 open_depth;            // share of the ambient light that arrives, and the depth for the blur

vec3 here, normal, to_eye;      // of the pixel
float shift;                    // of this pixel, another in each of a tile, 0…1
float last_far;                 // of the last sample on this half of a line [m]
ivec2 sampled;                  // texel of the sample
bool is_inside;                 // whether it shows something

// The estimator: a half of a line begins; a sample of it, from the pixel outwards, by its way from the
// pixel, the length of it, its distance on the picture as a share of the radius, and the area of the
// disc that it stands for, if that counts; the result. It is 0…1 in the mean over a tile: the blur
// limits it, as limits for each pixel would turn noise into shade.
void begin_half(vec2 direction);
void take(vec3 way, float far, float along, float area);
float occlusion();

float falloff(float far) { return wendland(far / radius); }

// How much a rise of the horizon counts: what hides the view is between the last sample and this one.
float rise_falloff(float far) { return falloff(mix(far, min(last_far, far), fill)); }

// The way to what is seen in another texel. Outside of the picture, and where it is empty, it is the ground, if any.
vec3 way_to(ivec2 offset) {
    vec3 there = vec3(0.0);
    if (all(greaterThanEqual(sampled, ivec2(0))) && all(lessThan(sampled, size)))
        there = texelFetch(place, sampled, 0).xyz;
    is_inside = there.z > 0.0;
    if (!is_inside) {
        vec3 ray = vec3(here.xy / here.z + vec2(offset) / focal, 1.0);
        float nearness = dot(ground, ray);
        if (nearness <= 0.0)
            return vec3(0.0, 0.0, FAR_BEHIND * radius);
        there = ray / nearness;
    }
    return there - here;
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 surface = texelFetch(normal_id, pixel, 0);
    open_depth = vec2(1.0, 0.0);
    if (surface.w < 0.5)
        return;
    here = texelFetch(place, pixel, 0).xyz;
    normal = surface.xyz;
    to_eye = -normalize(here);
    vec2 random = texelFetch(pattern, pixel % textureSize(pattern, 0), 0).xy;
    shift = fract(random.y + 7.0 * random.x);
    float reach = radius * focal / here.z;
    for (int line = 0; line < LINES; ++line) {
        float angle = PI * (float(line) + random.x) / float(LINES);
        vec2 direction = vec2(cos(angle), sin(angle));
        for (int half_line = 0; half_line < 2; ++half_line) {
            begin_half(direction);
            last_far = 0.0;
            for (int i = 0; i < SAMPLES / 2; ++i) {
                float t = (float(i) + random.y) / float(SAMPLES / 2);
                float along = t * mix(1.0, t, crowding);
                ivec2 offset = ivec2(round(direction * along * reach));
                if (offset == ivec2(0))
                    continue;
                sampled = pixel + offset;
                vec3 way = way_to(offset);
                float far = length(way);
                float area = along * mix(1.0, 2.0 * t, crowding);
                take(way, far, along, mix(1.0, area, by_area));
                last_far = far;
            }
            direction = -direction;
        }
    }
    open_depth = vec2(1.0 - darkness * occlusion(), here.z);
}
