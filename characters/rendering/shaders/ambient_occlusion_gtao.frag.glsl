#version 330 core

// Horizons with the cosine of the rendering equation (Jiménez, Wu, Pesce and Jarabo 2016, eq. 7 to 10).
// Each rise of the horizon is weighted by the distance that made it, as in Bavoil et al. 2008.

#include "seen_samples"
#include "half_line"

float sum = 0.0;
float angle, top;       // of the horizon, from the direction of the eye [rad], and its open light

void begin_half(vec2 direction) {
    turn_to(direction);
    angle = tilt + 0.5 * PI;
    top = light_up_to(angle);
}

void take(vec3 way, float far, float along, float area) {
    if (far >= radius || dot(normal, way) < bias * far)
        return;
    float elevation = acos(clamp(dot(way, to_eye) / far, -1.0, 1.0));
    if (elevation >= angle)
        return;
    float light = light_up_to(elevation);
    sum += share * rise_falloff(far) * (top - light);
    angle = elevation;
    top = light;
}

float occlusion() { return sum / float(LINES); }
