"""The sheet of paper that a cube is folded from."""
