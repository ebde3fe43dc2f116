"""Gestures: of a behaviour or a speech, on the upper body."""
