"""Bundled characters, made by code: sculpted, rigged and animated from seeds and principles."""
