"""A whole afternoon on a virtual desktop, with real key presses."""
