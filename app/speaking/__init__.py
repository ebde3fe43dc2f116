"""Speaking: what a character says while it plays, and performances of a text."""
