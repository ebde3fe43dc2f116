#version 330 core

// A point slides down the light onto the table and keeps its height. Instance 0 falls along the
// key light, into the left half of the map; instance 1 straight down, into the right half.

uniform vec4 area;      // origin x, z and side of the square that the map covers, height of the character
uniform vec2 slope;     // how far x and z move along the key light for each metre of height

in vec3 position;

out float height;

void main() {
    vec2 fall = gl_InstanceID == 0 ? slope : vec2(0.0);
    vec2 at = (position.xz - fall * position.y - area.xy) / area.z;
    height = max(position.y, 0.0) / area.w;
    gl_Position = vec4(at.x - (gl_InstanceID == 0 ? 1.0 : 0.0), at.y * 2.0 - 1.0, 0.0, 1.0);
}
