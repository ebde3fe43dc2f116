"""Finding which joint is which part of a body: by its name, by the tree, and by its shape."""
