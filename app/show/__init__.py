"""Plays: several characters speak and act by one file; see docs/talking.md."""
