"""Symbolic gestures: what a gesture is, independent of who performs it."""
