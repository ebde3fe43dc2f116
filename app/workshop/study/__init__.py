"""Studies with people: how their answers are counted."""
