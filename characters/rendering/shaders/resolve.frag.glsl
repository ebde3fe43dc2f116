#version 330 core

// The figures, drawn twice as fine: between four of their texels, the filter returns the mean.

uniform sampler2D figures;
uniform vec2 corner;    // of the place where they belong

out vec4 color;

void main() {
    color = texture(figures, 2.0 * (gl_FragCoord.xy - corner) / vec2(textureSize(figures, 0)));
}
