"""Markers and quads in an image, and the pose that their corners agree on."""
