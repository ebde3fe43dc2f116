"""Motion capture text formats: Biovision (.bvh) and Acclaim (.asf with .amc)."""
