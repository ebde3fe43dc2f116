#version 330 core

// A sample that is nearer to the camera than the pixel hides it (Mittring 2007; Huang 2013, eq. 3.3.1).
// On a plane one half of the samples is nearer, or none if it faces the camera: only more is occlusion.

#include "seen_samples"

float hidden = 0.0, total = 0.0;

void begin_half(vec2 direction) {}

void take(vec3 way, float far, float along, float area) {
    // What is too far in front cannot be told from an open view: it counts as a half.
    float nearer = way.z < -radius ? 0.5 : float(way.z < -bias * along * radius);
    hidden += area * nearer;
    total += area;
}

float occlusion() { return 2.0 * hidden / max(total, 1e-6) - 1.0; }
