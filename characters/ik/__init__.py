"""Inverse kinematics: legs, arms and trunk of the characters, and general solvers."""
