"""`reach`: the character reaches for the cube, holds it, and gives things."""
