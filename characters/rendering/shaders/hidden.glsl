// Share of a pixel on the table that neither a real cube nor a hand hides. Texels are pixels.
#ifdef HIDDEN
uniform sampler2D hidden;

float not_hidden() {
    return 1.0 - texelFetch(hidden, ivec2(gl_FragCoord.xy), 0).r;
}
#else
float not_hidden() {
    return 1.0;
}
#endif
