"""The robot's bundled likeness."""
