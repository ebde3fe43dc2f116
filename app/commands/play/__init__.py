"""The commands that play and replay sessions, and prepare the cube and the camera for it."""
