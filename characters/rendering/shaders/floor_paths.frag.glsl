#version 330 core

// A capsule about the x axis: half its length, its radius, and the radius of a hole (a disc and a ring
// are capsules without length). The paint is lit as the table is.

uniform vec3 light;     // light that a white sheet reflects, linear RGB

in vec2 at;
in vec3 capsule;
in vec3 paint;

out vec4 color;

#include "hidden"

void main() {
    float off = length(vec2(max(abs(at.x) - capsule.x, 0.0), at.y));
    float soft = max(fwidth(off), 1e-6);
    float cover = clamp((capsule.y - off) / soft + 0.5, 0.0, 1.0);
    if (capsule.z > 0.0) cover *= clamp((off - capsule.z) / soft + 0.5, 0.0, 1.0);
    vec3 lit = pow(clamp(paint * light, 0.0, 1.0), vec3(1.0 / 2.2));
    color = vec4(lit.bgr, 0.82 * cover * not_hidden());
}
