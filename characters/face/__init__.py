"""Faces: expressions, lids, blinks, the display of emotion, and speech."""
