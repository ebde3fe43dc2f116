// Light that comes from all around in the room, on a surface. Directions are in the table frame. After "shading".

uniform vec3 irradiance[9];     // coefficients of harmonics, see cube_map.py

// Light on a surface that is turned to n, with nothing near it.
vec3 light_of_room(vec3 n) {
    vec3 sum = irradiance[0] + n.y * irradiance[1] + n.z * irradiance[2] + n.x * irradiance[3];
    sum += n.x * n.y * irradiance[4] + n.y * n.z * irradiance[5] + n.x * n.z * irradiance[7];
    sum += (3.0 * n.z * n.z - 1.0) * irradiance[6] + (n.x * n.x - n.y * n.y) * irradiance[8];
    return max(sum, 0.0);       // of few harmonics, a bright lamp is negative behind
}

// What is left of light from a side, near the table: see light_around.
float left_near_table(float up, float above) {
    float near = near_table(above);
    return mix(0.55 + 0.45 * near, 1.0, up) * openness(up, near);
}

vec3 light_of_room_near(vec3 n, float above) {
    return light_of_room(n) * left_near_table(0.5 + 0.5 * n.y, above);
}
