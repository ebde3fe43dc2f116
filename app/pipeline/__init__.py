"""The whole line for one frame."""
