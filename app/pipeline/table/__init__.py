"""The table as a character finds it: what is on it, in the way, looked at and said."""
