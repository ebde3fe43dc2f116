"""Dialogue: parallel state machines that answer what is said to a character."""
