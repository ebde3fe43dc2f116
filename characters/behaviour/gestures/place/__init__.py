"""Where a gesture takes place: cells of space by arm length, directions, places on the body."""
