"""Graphs over the frames of recordings, of the whole body and of its parts, and their files."""
