"""The program: cube, character and robot in one line."""
