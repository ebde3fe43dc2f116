"""Motion capture: Biovision (.bvh) and Acclaim (.asf, .amc)."""
