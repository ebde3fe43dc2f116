#version 330 core

// Horizons with the cosine of the rendering equation (Jiménez, Wu, Pesce and Jarabo 2016, eq. 7 to 10).
// Each rise of the horizon is weighted by the distance that made it, as in Bavoil et al. 2008.

#include "ambient_occlusion"

float sum = 0.0;
float tilt;             // of the normal towards the half line, in the plane of the line and the eye [rad]
float share;            // of the normal that lies in this plane
float sine, cosine;     // of the tilt
float angle, top;       // of the horizon, from the direction of the eye [rad], and its open light

// ∫ cos(a − tilt) sin a da from 0 to an angle.
float light_up_to(float a) { return 0.25 * (cosine - cos(2.0 * a - tilt) + 2.0 * a * sine); }

void begin_half(vec2 direction) {
    vec3 along = normalize(vec3(direction, 0.0) - to_eye * dot(vec3(direction, 0.0), to_eye));
    vec2 flat_normal = vec2(dot(normal, along), max(dot(normal, to_eye), 1e-3));
    share = length(flat_normal);
    sine = flat_normal.x / share;
    cosine = flat_normal.y / share;
    tilt = asin(clamp(sine, -1.0, 1.0));
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
