"""Feet of retargeted motions: on the ground, in their places, and not sliding."""
