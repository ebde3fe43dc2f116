"""Realization: what a body does over time for the behaviours of a block."""
