"""The site: the guides and the rooms' pages as HTML, and the public names. `make docs`."""
