// For estimators that take what is seen in a sample for endless: the way to it.

#include "ambient_occlusion"

const float FAR_BEHIND = 4.0;   // where the background is taken to be [radii]

// A sample by its way from the cell [m], and the length of that; the others are as of the other.
void take(vec3 way, float far, float along, float area);

// How much a rise of the horizon counts: what hides the view is between the last sample and this one.
float rise_falloff(float far) { return falloff(mix(far, min(last_far, far), fill)); }

// Outside of the picture, and where it is empty, what is seen is the ground, if any.
vec3 way_to(ivec2 offset) {
    vec3 there = is_sampled_inside() ? texelFetch(place, texel_of(sampled), 0).xyz : vec3(0.0);
    if (there.z <= 0.0) {
        vec3 ray = sight(offset);
        float nearness = dot(ground, ray);
        if (nearness <= 0.0)
            return vec3(0.0, 0.0, FAR_BEHIND * radius);
        there = ray / nearness;
    }
    return there - here;
}

void take(ivec2 offset, float along, float area) {
    vec3 way = way_to(offset);
    float far = length(way);
    take(way, far, along, area);
    last_far = far;
}
