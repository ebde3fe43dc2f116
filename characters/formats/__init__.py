"""Files that characters and motions are read from and written to."""
