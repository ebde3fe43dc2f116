#version 330 core

// The supersampled characters: halfway between four texels, the linear filter returns their mean.

uniform sampler2D characters;
uniform vec2 corner;    // of their area in the region [px]

out vec4 color;

void main() {
    color = texture(characters, 2.0 * (gl_FragCoord.xy - corner) / vec2(textureSize(characters, 0)));
}
