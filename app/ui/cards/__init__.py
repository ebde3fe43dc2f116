"""The cards over the picture: what is on them, and where they lie."""
