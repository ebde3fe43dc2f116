// The plane of a half line and the eye: how the normal lies in it, and the light that comes from it, by the cosine of
// the rendering equation (Jiménez, Wu, Pesce and Jarabo 2016). After "ambient_occlusion".

float tilt;             // of the normal towards the half line, in this plane [rad]
float share;            // of the normal that lies in this plane
float sine, cosine;     // of the tilt

// ∫ cos(a − tilt) sin a da from 0 to an angle.
float light_up_to(float a) { return 0.25 * (cosine - cos(2.0 * a - tilt) + 2.0 * a * sine); }

void turn_to(vec2 direction) {
    vec3 along = normalize(vec3(direction, 0.0) - to_eye * dot(vec3(direction, 0.0), to_eye));
    vec2 flat_normal = vec2(dot(normal, along), max(dot(normal, to_eye), 1e-3));
    share = length(flat_normal);
    sine = flat_normal.x / share;
    cosine = flat_normal.y / share;
    tilt = asin(clamp(sine, -1.0, 1.0));
}
