"""Measuring how late the picture is, with the user's own screen and camera."""

MIN_FLIPS = 5
"""Fewer flips say nothing."""
