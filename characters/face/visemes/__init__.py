"""Visemes: the shapes of the mouth that speech sounds need, and how they run together."""
