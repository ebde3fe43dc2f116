"""Walking and running: gaits, stride blending, steering, and feet that stay planted."""
