"""Markers and quadrilaterals in a picture, and the pose that their corners agree on."""
