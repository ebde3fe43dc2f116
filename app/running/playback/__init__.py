"""Pausing, seeking, recording and exchanging parts: what the player asks of a running session."""
