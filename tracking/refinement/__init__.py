"""From an approximate pose to a precise one, by edges or by the motion-blurred image."""
