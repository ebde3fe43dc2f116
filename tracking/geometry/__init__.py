"""Rigid motions, cameras, and the values that travel between the stages of tracking."""
