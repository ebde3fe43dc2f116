"""Reaching: which hand goes to a place, by which way, and the body that brings it there."""
