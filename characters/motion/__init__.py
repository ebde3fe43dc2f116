"""Motions: clips, what modifies them, and what combines several of them."""
