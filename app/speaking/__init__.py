"""Speaking: what a character says while it plays, and videos of a text."""
