"""From an approximate pose to a precise one, by edges or by the image of the whole cube."""
