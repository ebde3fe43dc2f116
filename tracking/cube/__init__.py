"""The cube: its model and file, its markers, edges and faces."""
