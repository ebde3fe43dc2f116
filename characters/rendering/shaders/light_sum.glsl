// All light of a texel, linear, from the shares of the light buffer.

uniform sampler2D diffuse;
uniform sampler2D specular;
uniform sampler2D ambient;

vec3 light_sum(ivec2 texel) {
    return texelFetch(diffuse, texel, 0).rgb + texelFetch(specular, texel, 0).rgb
         + texelFetch(ambient, texel, 0).rgb;
}
