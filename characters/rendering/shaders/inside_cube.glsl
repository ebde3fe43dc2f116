// Cuts off what is outside of the cube that a character stands in.
#ifdef CLIPPED
uniform mat4 cube_from_table;   // the cube's edge is 1 long

out float gl_ClipDistance[6];

void clip_to_cube(vec3 point) {
    vec3 place = (cube_from_table * vec4(point, 1.0)).xyz;
    for (int axis = 0; axis < 3; ++axis) {
        gl_ClipDistance[2 * axis] = 0.5 - place[axis];
        gl_ClipDistance[2 * axis + 1] = 0.5 + place[axis];
    }
}
#else
void clip_to_cube(vec3 point) {}
#endif
