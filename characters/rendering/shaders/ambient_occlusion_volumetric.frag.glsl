#version 330 core

// Volumetric obscurance (Loos and Sloan 2010): the free share of chords through a sphere around the
// pixel. On any plane it is one half: only less than that is occlusion.

#include "seen_samples"

float free = 0.0, whole = 0.0;

void begin_half(vec2 direction) {}

void take(vec3 way, float far, float along, float area) {
    float chord = radius * sqrt(max(1.0 - along * along, 0.0));    // a half of it
    float in_front = clamp(way.z + chord + bias * along * radius, 0.0, 2.0 * chord);
    if (way.z < -2.0 * radius)  // what is too far in front counts as a half
        in_front = chord;
    free += area * in_front;
    whole += area * 2.0 * chord;
}

float occlusion() { return 1.0 - 2.0 * free / max(whole, 1e-6); }
