"""From where the cube is to what the hand does with it."""
