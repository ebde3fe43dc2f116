"""A browser as window and camera: a page, and the server that exchanges pictures with it."""
