"""The benchmark of the tracker: drawn by its own renderer, run against the rivals."""
