// What is seen in each texel of a character layer, see GeometryBuffer. Directions and positions are in the
// camera frame: x right, y down, z forward.

uniform sampler2D normal_id;
uniform sampler2D position;
uniform sampler2D albedo_rough;
uniform sampler2D shade_metal;
uniform sampler2D glow_open;

// Whether a character is seen here.
bool is_seen(float id) {
    return id > 0.5;
}

uniform sampler2D surfaces;     // a row for each surface, see surface_records

// Row of a surface in the records; those beyond the last share it.
int surface_row(float id) {
    return min(int(id + 0.5), textureSize(surfaces, 0).y) - 1;
}
