#version 330 core

// Visibility bitmask (Therrien, Levesque and Gilet 2023): a half line sees 32 sectors of equal light, by the
// cosine of the rendering equation (Jiménez et al. 2016), and what is seen there hides those between its front and
// its back. What is behind it hides others. A sector counts by the distance of what hides it first. No light comes
// from below the triangle, whatever its normals for shading say.

#include "ambient_occlusion"
#include "half_line"

const float STEEPEST = 1.5;     // greatest slope between two samples at which they may be of one surface

uniform sampler2D depths;       // of each cell: end of what is seen, start and end of the next thing, start of what is seen [m]

float sum = 0.0;
float above = 0.0;              // light of all half lines
float lowest;                   // cosine of the angle between the eye and the last of the sectors
float whole;                    // light of all sectors
uint hidden;                    // a bit for each sector, the first at the eye
vec4 last;                      // of what is seen in the last sample: cosines of the angles to both ends, and their depths

int bit_count(uint v) {
    v -= (v >> 1) & 0x55555555u;
    v = (v & 0x33333333u) + ((v >> 2) & 0x33333333u);
    return int((((v + (v >> 4)) & 0x0F0F0F0Fu) * 0x01010101u) >> 24);
}

int exponent(uint v) { return int(floatBitsToUint(float(v)) >> 23) - 127; }

// The middle between the start of the first sector that is set and the end of the last.
float middle(uint sectors) {
    return 0.5 * float(exponent(sectors & (~sectors + 1u)) + exponent(sectors) + 1);
}

// As light_up_to, by the cosine of the angle: a polynomial stands for asin c + c sqrt(1 − c²), to 2e-3.
vec2 light_up_to_cosine(vec2 c) {
    vec2 s = c * c;
    vec2 arc = c * (2.0 + s * (-0.3791 + s * (0.1149 - 0.1650 * s)));
    return 0.5 * (cosine * (1.0 - s) + sine * (0.5 * PI - arc));
}

void begin_half(vec2 direction) {
    turn_to(direction);
    vec2 flat_tilt = vec2(dot(flat_normal, along_line), max(dot(flat_normal, to_eye), 1e-3));
    lowest = max(-sine, -flat_tilt.x / length(flat_tilt));
    whole = max(light_up_to_cosine(vec2(lowest)).x, 1e-6);
    above += share * whole;
    hidden = 0u;
    last = vec4(0.0);
}

// Hide what is between two depths of a line of sight; return the cosines of both ends, and the depths. `before` is that
// of the last sample, or 0; `gap` the distance from there [m], `nearer` how much nearer what is met between them is.
vec4 hide(vec3 ray, vec2 depths, vec4 before, float gap, float nearer) {
    // From here to what is at a depth, the way is start + past · ray.
    vec3 start = here.z * ray - here;
    vec2 past = depths - here.z;
    float start_ray = dot(start, ray), ray_ray = dot(ray, ray), start_start = dot(start, start);
    vec2 per_far = inversesqrt(start_start + past * (2.0 * start_ray + past * ray_ray));
    vec2 ends = clamp((dot(start, to_eye) + past * dot(ray, to_eye)) * per_far, -1.0, 1.0);
    vec4 result = vec4(ends, depths);
    if ((dot(flat_normal, start) + past.x * dot(flat_normal, ray)) * per_far.x < bias)
        return result;
    if (before.w > 0.0 && depths.x < before.w + STEEPEST * gap && before.z < depths.y + STEEPEST * gap)
        ends = vec2(max(ends.x, before.x), min(ends.y, before.y));  // it goes on from the last sample
    ends.y = max(ends.y, lowest);
    if (ends.x <= ends.y)
        return result;
    // The shift makes rounding right in the mean over a tile.
    ivec2 sectors = clamp(ivec2(32.0 / whole * light_up_to_cosine(ends) + shift), 0, 32);
    int count = sectors.y - sectors.x;
    if (count <= 0)
        return result;
    uint fresh = (count == 32 ? ~0u : ((1u << uint(count)) - 1u) << uint(sectors.x)) & ~hidden;
    if (fresh == 0u)
        return result;
    hidden |= fresh;
    // Where the middle of these sectors meets the line of sight: its direction is a mean of those to both ends.
    float part = clamp((middle(fresh) - float(sectors.x)) / float(count), 0.0, 1.0);
    float between = (start_start + (past.x + past.y) * start_ray + past.x * past.y * ray_ray) * per_far.x * per_far.y;
    float far = sqrt(1.0 - 2.0 * part * (1.0 - part) * (1.0 - between)) / mix(per_far.x, per_far.y, part);
    sum += share * whole / 32.0 * float(bit_count(fresh)) * falloff(nearer * far);
    return result;
}

void take(ivec2 offset, float along, float area) {
    vec3 ray = sight(offset);
    vec4 found = is_sampled_inside() ? texelFetch(depths, sampled, 0) : vec4(NOTHING);
    if (found.w == NOTHING) {
        float nearness = dot(ground, ray);
        if (nearness * NOTHING <= 1.0) {
            last = vec4(0.0);
            return;
        }
        found = vec4(vec3(NOTHING), 1.0 / nearness);
    }
    float gap = (along - last_along) * radius, nearer = mix(1.0, last_along / along, fill);
    last = hide(ray, found.wx, last, gap, nearer);
    if (found.y < NOTHING)
        hide(ray, vec2(found.y, found.z < found.y ? NOTHING : found.z), vec4(0.0), gap, nearer);
}

float occlusion() { return sum / above; }
