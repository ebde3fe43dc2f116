#version 330 core

// Visibility bitmask (Therrien, Levesque and Gilet 2023): a half line sees 32 sectors of equal light, by the
// cosine of the rendering equation (Jiménez et al. 2016), and what is seen there hides those between its front and
// its back. What is behind it hides others. A sector counts by the distance of what hides it first.

#include "ambient_occlusion"
#include "half_line"

const float STEEPEST = 1.5;     // greatest slope between two samples at which they may be of one surface

uniform sampler2D behind;       // where what is seen ends, and the next thing begins and ends: depths [m]
uniform bool has_behind;        // otherwise everything goes on for ever

float sum = 0.0;
float lowest;                   // of the sectors, from the direction of the eye [rad]
float whole;                    // light of all sectors
uint hidden;                    // a bit for each sector, the first at the eye
float last_along;               // of the last sample on this half of a line
vec4 last[2];                   // angles and depths of the last sample's first and second thing

int bit_count(uint v) {
    v -= (v >> 1) & 0x55555555u;
    v = (v & 0x33333333u) + ((v >> 2) & 0x33333333u);
    return int((((v + (v >> 4)) & 0x0F0F0F0Fu) * 0x01010101u) >> 24);
}

// The middle between the start of the first sector that is set and the end of the last.
float middle(uint sectors) {
    return 0.5 * (log2(float(sectors & (~sectors + 1u))) + floor(log2(float(sectors))) + 1.0);
}

void begin_half(vec2 direction) {
    turn_to(direction);
    lowest = tilt + 0.5 * PI;
    whole = max(light_up_to(lowest), 1e-6);
    hidden = 0u;
    last_along = 0.0;
    last[0] = last[1] = vec4(0.0);
}

// The angle between a way and that to the eye, to 1e-4 (Abramowitz and Stegun 1964, 4.4.45).
float angle_to(vec3 way, float far) {
    float x = dot(way, to_eye) / far, y = min(abs(x), 1.0);
    float angle = sqrt(1.0 - y) * (1.5707288 + y * (-0.2121144 + y * (0.0742610 - 0.0187293 * y)));
    return x < 0.0 ? PI - angle : angle;
}

// Hide what is between two depths of a line of sight. `gap` is the distance from the last sample [m], `nearer` how
// much nearer what is met between them is.
void hide(int layer, vec3 there, vec2 depths, float gap, float nearer) {
    vec3 front = there * (depths.x / there.z) - here, back = there * (depths.y / there.z) - here;
    float far = length(front), further = length(back);
    float top = angle_to(front, far), bottom = angle_to(back, further);
    vec4 before = last[layer];
    last[layer] = vec4(top, bottom, depths);
    if (dot(normal, front) < bias * far)
        return;
    vec2 ends = vec2(top, bottom);
    if (before.w > 0.0 && depths.x < before.w + STEEPEST * gap && before.z < depths.y + STEEPEST * gap)
        ends = vec2(min(top, before.x), max(bottom, before.y));     // it goes on from the last sample
    ends.y = min(ends.y, lowest);
    if (ends.x >= ends.y)
        return;
    // The shift makes rounding right in the mean over a tile.
    ivec2 sectors = ivec2(32.0 / whole * vec2(light_up_to(ends.x), light_up_to(ends.y)) + shift);
    sectors = clamp(sectors, 0, 32);
    int count = sectors.y - sectors.x;
    if (count <= 0)
        return;
    uint fresh = (count == 32 ? ~0u : ((1u << uint(count)) - 1u) << uint(sectors.x)) & ~hidden;
    if (fresh == 0u)
        return;
    hidden |= fresh;
    // Where the middle of these sectors meets the line of sight.
    float angle = mix(ends.x, ends.y, clamp((middle(fresh) - float(sectors.x)) / float(count), 0.0, 1.0));
    float between = sin(bottom - top);
    float nearness = between < 1e-4 ? 1.0 / far
        : (sin(bottom - angle) / far + sin(angle - top) / further) / between;
    if (nearness > 0.0)
        sum += share * whole / 32.0 * float(bit_count(fresh)) * falloff(nearer / nearness);
}

void take(vec3 way, float far, float along, float area) {
    float gap = (along - last_along) * radius, nearer = mix(1.0, last_along / along, fill);
    last_along = along;
    vec3 there = here + way;
    vec3 ends = has_behind && is_inside ? texelFetch(behind, sampled, 0).xyz : vec3(NOTHING);
    if (ends.z < ends.y)
        ends.z = NOTHING;
    float nearness = dot(ground, there / there.z);
    if (ends.y == NOTHING && nearness * ends.x > 1.0)
        ends.y = 1.0 / nearness;    // the ground is behind it
    hide(0, there, vec2(there.z, ends.x), gap, nearer);
    if (ends.y < NOTHING)
        hide(1, there, ends.yz, gap, nearer);
    else
        last[1] = vec4(0.0);
}

float occlusion() { return sum / float(LINES); }
