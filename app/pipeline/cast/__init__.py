"""The cast: the characters on the table, and what each of them does in a frame."""
