"""Faces: expressions, lids, blinks, and the display of emotion."""
