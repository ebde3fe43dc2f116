"""Measuring how late the picture is, with the user's own screen and camera."""
