"""Makes the bundled character `robot`, which the virtual robot shows."""
