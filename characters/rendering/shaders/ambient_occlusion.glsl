// Ambient occlusion in the picture's plane (Huang 2013, ch. 3): LINES lines of SAMPLES samples through
// each cell, the cell itself among them. The estimator that includes this file says what they mean.

#include "wendland"
#include "cells"
#include "flat_normal"

const float PI = 3.14159265;
const float NOTHING = 1e3;      // depth at which there is nothing [m]

uniform sampler2D normal_id;    // unit normal in the camera frame, and ID in w: below 0.5 is background
uniform sampler2D place;        // position in the camera frame [m]; z is 0 in the background; and the flat normal
uniform sampler2D pattern;      // of the tile: turn of the lines, shift of their samples, both 0…1
uniform vec3 ground;            // a point is on the plane where nothing else is if its product with this is 1
uniform float radius;           // occluders farther away do not count [m]
uniform float focal;            // focal length [texels]
uniform float span;             // share of the radius in which samples are
uniform float apart;            // distance from one sample to the next at least [cells]
uniform float crowding;         // 0: samples are spread evenly along a line, 1 and 2: they crowd at the cell
uniform float by_area;          // 0: every sample counts the same, 1: by the area that it stands for
uniform float bias;             // sine of the elevation above the surface from which on samples count
uniform float fill;             // where a rise of the horizon is: 0 at the sample that made it, 1 at the last
uniform float darkness;         // gain of the occlusion

out vec2 open_depth;            // share of the ambient light that arrives, and the depth for the blur

vec3 here, normal, to_eye;      // of the cell
vec3 flat_normal;               // of its triangle
float shift;                    // of this cell, another in each of a tile, 0…1
float last_along, last_far;     // of the last sample on this half of a line; the second if the estimator keeps it [m]
ivec2 sampled;                  // cell of the sample

// The estimator: a half of a line begins; a sample of it, from the cell outwards, by its way from there [cells],
// its distance on the picture as a share of the radius, and the area of the disc that it stands for, if that counts;
// the result. It is 0…1 in the mean over a tile: the blur limits it, as limits for each cell would turn noise
// into shade.
void begin_half(vec2 direction);
void take(ivec2 offset, float along, float area);
float occlusion();

float falloff(float far) { return wendland(far / radius); }

// The line of sight through another cell: its point at a depth of 1.
vec3 sight(ivec2 offset) { return vec3(here.xy / here.z + vec2(stride * offset) / focal, 1.0); }

bool is_sampled_inside() {
    return all(greaterThanEqual(sampled, ivec2(0))) && all(lessThanEqual(sampled, last_cell));
}

void main() {
    ivec2 cell = ivec2(gl_FragCoord.xy);
    vec4 surface = texelFetch(normal_id, texel_of(cell), 0);
    open_depth = vec2(1.0, 0.0);
    if (surface.w < 0.5)
        return;
    vec4 found = texelFetch(place, texel_of(cell), 0);
    here = found.xyz;
    flat_normal = normal_of_number(found.w);
    normal = surface.xyz;
    to_eye = -normalize(here);
    vec2 random = texelFetch(pattern, cell % textureSize(pattern, 0), 0).xy;
    shift = random.y;
    float reach = radius * focal / (here.z * float(stride));
    float spread = max(span * reach - apart * float(SAMPLES / 2), 0.0);
    for (int line = 0; line < LINES; ++line) {
        float angle = PI * (float(line) + random.x) / float(LINES);
        vec2 direction = vec2(cos(angle), sin(angle));
        for (int half_line = 0; half_line < 2; ++half_line) {
            begin_half(direction);
            last_along = last_far = 0.0;
            for (int i = 0; i < SAMPLES / 2; ++i) {
                float t = (float(i) + shift) / float(SAMPLES / 2);
                float crowded = t * mix(1.0, t, min(crowding, 1.0)) * mix(1.0, t, max(crowding - 1.0, 0.0));
                float away = spread * crowded + apart * (float(i) + shift + 0.5);
                ivec2 offset = ivec2(round(direction * away));
                if (offset == ivec2(0))
                    continue;
                sampled = cell + offset;
                float along = away / reach;
                take(offset, along, mix(1.0, along * mix(1.0, 2.0 * t, crowding), by_area));
                last_along = along;
            }
            direction = -direction;
        }
    }
    open_depth = vec2(1.0 - darkness * occlusion(), here.z);
}
