#version 330 core

// Projects a point onto the table and keeps its height. Instance 0 is projected along the key light,
// into the left half of the map; instance 1 straight down, into the right half.

uniform vec4 area;      // origin x, z and side of the square that the map covers, height of the character
uniform mat4 floor_from_table; // the floor's frame: +y up, the floor at y = 0 [m]
uniform vec2 slope;     // horizontal offset (x, z) along the key light for each metre of height

in vec3 position;

out float height;

void main() {
    vec3 place = (floor_from_table * vec4(position, 1.0)).xyz;
    vec2 offset = gl_InstanceID == 0 ? slope : vec2(0.0);
    vec2 at = (place.xz - offset * place.y - area.xy) / area.z;
    height = max(place.y, 0.0) / area.w;
    gl_Position = vec4(at.x - (gl_InstanceID == 0 ? 1.0 : 0.0), at.y * 2.0 - 1.0, 0.0, 1.0);
}
