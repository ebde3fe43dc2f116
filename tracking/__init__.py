"""Camera frames in; where the cube is, and what the hand does with it, out."""
