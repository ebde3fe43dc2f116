"""Skeletons, poses and rotations; which joint is which part of the body."""
