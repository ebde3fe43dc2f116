"""The summary of a session: its figures, and the gaps in it."""
