"""What is told of cubes: their tracks, and what is wrong with a print."""
