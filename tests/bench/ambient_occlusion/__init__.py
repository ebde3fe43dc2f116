"""Ambient occlusion against a ray tracer: quality, time, and the search for the constants."""
