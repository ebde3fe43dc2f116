// Cells of `stride` × `stride` texels, each of which stands for the texel in its middle.

uniform ivec2 last_texel;       // of the part of the picture that is used
uniform ivec2 last_cell;
uniform int stride;

ivec2 texel_of(ivec2 cell) { return min(stride * cell + stride / 2, last_texel); }
