// The normal of a triangle, which looks to the camera, in one number: its stereographic projection from +z, −2 … 2, with
// 12 bits for each coordinate.

float number_of_normal(vec3 normal) {
    vec2 cell = floor(clamp(normal.xy / (1.0 - normal.z), -1.999, 1.999) * 1024.0 + 2048.5);
    return cell.x * 4096.0 + cell.y;
}

vec3 normal_of_number(float number) {
    vec2 plane = (vec2(floor(number / 4096.0), mod(number, 4096.0)) - 2048.0) / 1024.0;
    return vec3(2.0 * plane, dot(plane, plane) - 1.0) / (dot(plane, plane) + 1.0);
}
