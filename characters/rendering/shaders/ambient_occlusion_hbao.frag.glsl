#version 330 core

// Horizon-based ambient occlusion (Bavoil, Sainz and Dimitrov 2008): the sine of the horizon's
// elevation less that of the tangent, each rise of the horizon weighted by the distance that made it.

#include "seen_samples"

float sum = 0.0, top;

void begin_half(vec2 direction) {
    vec3 along = normalize(vec3(direction, 0.0) - to_eye * dot(vec3(direction, 0.0), to_eye));
    float slope = -dot(normal, along) / max(dot(normal, to_eye), 0.05);
    top = slope * inversesqrt(1.0 + slope * slope);
}

void take(vec3 way, float far, float along, float area) {
    float sine = dot(way, to_eye) / far;
    if (far >= radius || sine <= top || dot(normal, way) < bias * far)
        return;
    sum += rise_falloff(far) * (sine - top);
    top = sine;
}

float occlusion() { return sum / float(2 * LINES); }
