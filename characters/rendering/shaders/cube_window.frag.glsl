#version 330 core

// The near faces of an open cube. Each keeps a rim of the camera's picture, which only hides what is behind it;
// through the hole in its middle, the ray from the eye meets the hole's own edge or a wall of the room inside.
// All places are in the frame of a cube whose edge is 1 long.

const float RIM = 0.055, WALL = 0.025;   // width of the rim and thickness of the walls; as in cube_window.py
const float CORNER = 0.08;              // radius of the hole's corners
const float INNER = 0.5 - WALL;         // half the room's side

uniform mat4 clip_from_cube;
uniform vec3 eye;
uniform vec3 up;            // of the table, a unit vector
uniform vec3 to_light;      // a unit vector
uniform vec3 key;           // linear RGB, as in `Light`
uniform vec3 sky;
uniform float opening;      // 0…1
uniform float open_faces[6]; // how far light comes in through +x, −x, +y, −y, +z, −z: 0…1
#ifdef SHADOW
uniform sampler2D factors;  // light that is left on the floor, of a shadow map
uniform mat4 floor_from_cube; // [m]; +y up, the floor at y = 0
uniform vec4 area;          // origin x, z and side of the square that the map covers
uniform vec4 extent;        // lowest x and z, highest x and z of the shadow
uniform float edge;         // of the cube [m]
#endif

in vec3 at;
flat in vec3 outward;

out vec4 color;

// Coordinates of a point along the two axes of a face.
vec2 across(vec3 point, int axis) {
    return axis == 0 ? point.yz : axis == 1 ? point.zx : point.xy;
}

// Signed distance from the edge of a face's hole, a square with round corners; negative inside.
float hole(vec2 place) {
    float half_side = (0.5 - RIM) * opening, radius = min(CORNER, half_side);
    vec2 off = abs(place) - half_side + radius;
    return length(max(off, 0.0)) + min(max(off.x, off.y), 0.0) - radius;
}

// Share of the light from one direction that reaches a point inside through the holes, with a soft edge.
float reached(vec3 point) {
    vec3 far = (sign(to_light) * 0.5 - point) / to_light;
    int axis = far.x < far.y ? (far.x < far.z ? 0 : 2) : (far.y < far.z ? 1 : 2);
    float way = far[axis], soft = 0.015 + 0.10 * way;
    float through = smoothstep(soft, -soft, hole(across(point + way * to_light, axis)));
    return through * open_faces[2 * axis + (to_light[axis] < 0.0 ? 1 : 0)];
}

// Light from all around, which comes through the holes and from wall to wall.
vec3 ambient(vec3 point, vec3 facing) {
    float open = 0.0, closed = 1.0;
    for (int face = 0; face < 6; ++face) {
        vec3 out_of = vec3(0.0);
        out_of[face / 2] = face % 2 == 0 ? 1.0 : -1.0;
        float away = INNER - dot(point, out_of);
        open += open_faces[face] * (0.35 + 0.65 * max(dot(facing, out_of), 0.0)) / (1.0 + 1.6 * away * away);
        // Walls that meet darken each other, unless there is a hole in one.
        if (abs(dot(facing, out_of)) < 0.5)
            closed *= 1.0 - (0.42 - 0.3 * open_faces[face]) * exp(-away / 0.10);
    }
    return sky * (0.42 + 0.74 * min(open, 1.6)) * closed * vec3(1.06, 1.0, 0.92);
}

// What the walls look like. A wall becomes the floor as it turns downwards.
vec3 painted(vec3 point, vec3 facing, float size) {
    int axis = abs(facing.x) > 0.5 ? 0 : abs(facing.y) > 0.5 ? 1 : 2;
    vec2 place = across(point, axis);
    float rise = dot(facing, up);
    float flat_floor = smoothstep(0.55, 0.80, rise);

    // Planks, each of its own brightness, with a dark gap between two.
    float row = place.x / 0.105 + 0.5, number = floor(row);
    float tint = fract(sin(number * 12.9898) * 43758.5453);
    float shift = fract(tint * 7.31) + place.y / 0.62, joint = abs(fract(shift) - 0.5);
    float gap = min(0.5 - abs(fract(row) - 0.5), 6.0 * (0.5 - joint)) * 0.105;
    vec3 planks = vec3(0.46, 0.25, 0.115) * (0.82 + 0.36 * fract(tint * 3.7 + floor(shift) * 0.37));
    planks *= mix(0.45, 1.0, smoothstep(0.0, 0.004 + size, gap));
    float from_middle = length(place);
    float rug = 1.0 - smoothstep(-size, size, from_middle - 0.31);
    float ring = smoothstep(-size, size, from_middle - 0.255) * (1.0 - smoothstep(-size, size, from_middle - 0.285));
    rug *= smoothstep(0.72, 0.92, rise);
    planks = mix(planks, mix(vec3(0.055, 0.23, 0.26), vec3(0.80, 0.66, 0.42), ring), rug);

    // Striped paper above, panels below, a rail between them; only where the cube stands upright on a face.
    vec3 most = abs(up);
    int tall = most.x > most.y ? (most.x > most.z ? 0 : 2) : (most.y > most.z ? 1 : 2);
    float height = INNER + point[tall] * sign(up[tall]);
    float upright = smoothstep(0.74, 0.86, most[tall]);
    vec3 paper = vec3(0.95, 0.66, 0.36), panel = vec3(0.46, 0.13, 0.07), rail = vec3(0.88, 0.76, 0.58);
    int level = axis == tall ? (axis + 1) % 3 : 3 - axis - tall;
    float from_stripe = 0.14 * (abs(fract(point[level] / 0.14) - 0.5) - 0.25);
    float stripe = smoothstep(-size, size, from_stripe);
    float low = 1.0 - smoothstep(-size, size, height - 0.27);
    float on_rail = 1.0 - smoothstep(-size, size, abs(height - 0.28) - 0.016);
    float on_skirting = 1.0 - smoothstep(-size, size, height - 0.035);
    vec3 wall = mix(mix(paper, vec3(0.90, 0.42, 0.22), stripe), panel, low);
    wall = mix(wall, rail, max(on_rail, on_skirting));
    wall = mix(paper, wall, upright * (1.0 - smoothstep(0.55, 0.80, abs(rise))));
    return mix(wall, planks, flat_floor);
}

void main() {
    int axis = abs(outward.x) > 0.5 ? 0 : abs(outward.y) > 0.5 ? 1 : 2;
    float edge_distance = hole(across(at, axis));
    float pixel = max(fwidth(edge_distance), 1e-6), size = 0.5 * length(fwidth(at));
    vec3 along = normalize(at - eye);
    float inward = -dot(along, outward);
    if (inward <= 0.0) discard;  // a far face: the near ones hide it
    float shown = clamp(0.5 - edge_distance / pixel, 0.0, 1.0);
    vec3 point = at, light = vec3(0.0);
    if (shown > 0.0) {
        vec3 step_in = along * (WALL / inward);
        if (hole(across(at + step_in, axis)) > 0.0) {
            // The edge of the paper: where the ray leaves the hole sideways.
            float low = 0.0, high = 1.0;
            for (int i = 0; i < 8; ++i) {
                float middle = 0.5 * (low + high);
                if (hole(across(at + middle * step_in, axis)) > 0.0) high = middle; else low = middle;
            }
            point = at + high * step_in;
            vec3 facing = -(point - outward * dot(point, outward));
            facing = abs(facing.x) > max(abs(facing.y), abs(facing.z)) ? vec3(sign(facing.x), 0.0, 0.0)
                   : abs(facing.y) > abs(facing.z) ? vec3(0.0, sign(facing.y), 0.0) : vec3(0.0, 0.0, sign(facing.z));
            float lit = max(dot(facing, to_light), 0.0);
            light = vec3(0.80, 0.77, 0.71) * (sky * (0.95 - 0.35 * high) + key * lit * (1.0 - 0.4 * high));
        } else {
            vec3 begin = at + step_in;
            vec3 far = (sign(along) * INNER - begin) / along;
            int wall = far.x < far.y ? (far.x < far.z ? 0 : 2) : (far.y < far.z ? 1 : 2);
            point = begin + far[wall] * along;
            vec3 facing = vec3(0.0);
            facing[wall] = -sign(along[wall]);
            float reach = dot(point - eye, along) / dot(at - eye, along);
            size *= reach / max(abs(dot(facing, along)), 0.2);
            vec3 fallen = key * max(dot(facing, to_light), 0.0) * reached(point) + ambient(point, facing);
            light = painted(point, facing, size) * fallen;
#ifdef SHADOW
            vec3 on_floor = (floor_from_cube * vec4(point, 1.0)).xyz;
            vec2 place = on_floor.xz;
            if (all(greaterThan(place, extent.xy)) && all(lessThan(place, extent.zw))) {
                float near = 1.0 - smoothstep(0.02, 0.05, abs(on_floor.y) / edge);
                vec2 where = (place - area.xy) / area.z;
                vec3 left = textureLod(factors, where, 0.0).bgr;
                light *= mix(vec3(1.0), pow(left, vec3(2.2)), near);
            }
#endif
        }
    }
    vec4 clip = clip_from_cube * vec4(point, 1.0);
    gl_FragDepth = 0.5 + 0.5 * clip.z / clip.w;
    light *= 1.06 / (1.0 + 0.12 * light);  // as characters are
    color = vec4(pow(clamp(light, 0.0, 1.0), vec3(1.0 / 2.2)).bgr, 1.0) * shown;
}
