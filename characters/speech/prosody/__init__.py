"""Prosody: pitch, strength, stress and pitch accents of recorded speech."""
