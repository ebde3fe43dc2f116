"""The camera's picture: its lens, light and haze, and what of it hides characters."""
