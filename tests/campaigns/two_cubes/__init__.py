"""Two cubes that cross, are covered and swapped: none is taken for the other."""
