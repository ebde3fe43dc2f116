"""Solvers of chains of joints, in batches: springs, CCD, FABRIK, Jacobians, several targets."""
