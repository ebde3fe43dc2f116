"""Frames that come over a network."""
