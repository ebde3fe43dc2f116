#version 330 core

// A point of a character between vertices that are already shaded.

in vec3 shade;              // as the picture shows it

out vec4 color;

void main() {
    color = vec4(shade, 1.0);
}
