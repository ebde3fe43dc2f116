#version 330 core

// The angle between a sample and the surface's normal (Huang 2013, ch. 3.3), as occlusion.

#include "seen_samples"

float sum = 0.0, total = 0.0;

void begin_half(vec2 direction) {}

void take(vec3 way, float far, float along, float area) {
    sum += area * max(dot(normal, way) / far - bias, 0.0) * falloff(far);
    total += area;
}

float occlusion() { return sum / max(total, 1e-6); }
