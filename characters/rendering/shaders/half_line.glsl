// The plane of a half line and the eye: how the normal lies in it, and the light that comes from it, by the cosine of
// the rendering equation (Jiménez, Wu, Pesce and Jarabo 2016). After "ambient_occlusion".

float tilt;             // of the normal towards the half line, in this plane [rad]
float share;            // of the normal that lies in this plane
float sine, cosine;     // of the tilt
vec3 along_line;        // direction of the half line, orthogonal to that of the eye

// ∫ cos(a − tilt) sin a da from 0 to an angle.
float light_up_to(float a) { return 0.25 * (cosine - cos(2.0 * a - tilt) + 2.0 * a * sine); }

void turn_to(vec2 direction) {
    along_line = normalize(vec3(direction, 0.0) - to_eye * dot(vec3(direction, 0.0), to_eye));
    vec2 in_plane = vec2(dot(normal, along_line), max(dot(normal, to_eye), 1e-3));
    share = length(in_plane);
    sine = in_plane.x / share;
    cosine = in_plane.y / share;
    tilt = asin(clamp(sine, -1.0, 1.0));
}
