"""Motion graphs from a person's own recordings: building them, and showing them."""
