#version 330 core

// Linear blend skinning. The palette has one row for each joint: the first three rows of
// table_from_bind; most vertices follow one joint or two, so that the loop ends with the last that
// counts. Normals are transformed by the cofactors, which are right under any scale.

uniform sampler2D palette;

in vec3 position;
in vec3 normal;
in uvec4 joints;
in vec4 weights;

out vec3 skinned_position;
out vec3 skinned_normal;

void main() {
    vec4 x = vec4(0.0), y = vec4(0.0), z = vec4(0.0);
    uvec4 left = joints;
    vec4 shares = weights;
    do {
        int joint = int(left.x);
        x += shares.x * texelFetch(palette, ivec2(0, joint), 0);
        y += shares.x * texelFetch(palette, ivec2(1, joint), 0);
        z += shares.x * texelFetch(palette, ivec2(2, joint), 0);
        left = left.yzwx;
        shares = vec4(shares.yzw, 0.0);
    } while (shares != vec4(0.0));
    vec4 point = vec4(position, 1.0);
    skinned_position = vec3(dot(x, point), dot(y, point), dot(z, point));
    vec3 turned = vec3(
        dot(cross(y.xyz, z.xyz), normal),
        dot(cross(z.xyz, x.xyz), normal),
        dot(cross(x.xyz, y.xyz), normal));
    float size = length(turned);
    skinned_normal = size > 0.0 ? turned / size : vec3(0.0, 1.0, 0.0);
}
