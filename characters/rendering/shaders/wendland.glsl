// Weight of what is at a share 0…1 of a radius: 1 in the middle, 0 from the radius on (Wendland, 1995; Huang 2013, 3.3.3).
float wendland(float share) {
    float rest = max(1.0 - share, 0.0);
    return rest * rest * rest * rest * (4.0 * share + 1.0);
}
