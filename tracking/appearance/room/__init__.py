"""The light that comes from all around in a room, as an environment map."""
