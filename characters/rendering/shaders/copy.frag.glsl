#version 330 core

uniform sampler2D picture;

in vec2 at;

out vec4 color;

void main() {
    color = vec4(texture(picture, at).bgr, 1.0);
}
