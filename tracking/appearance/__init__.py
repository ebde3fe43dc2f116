"""What the tracked cube tells of the picture: the light, the hand, the camera's blur and noise."""
