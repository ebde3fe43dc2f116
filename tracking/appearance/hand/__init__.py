"""The hand in front of the cube: its print, the desk, and the colours of both."""
