"""Who takes part: the log of each, at a terminal or simulated."""
