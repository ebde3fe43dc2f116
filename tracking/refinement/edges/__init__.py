"""The edges of a cube: where they lie in the image, and the pose that fits them."""
