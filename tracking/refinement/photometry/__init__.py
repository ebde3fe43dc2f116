"""The image of a whole cube, at rest or blurred by motion, compared with its rendering."""
