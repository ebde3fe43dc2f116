"""The commands that are for robots, here and on other computers."""
