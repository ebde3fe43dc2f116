"""What a robot or a character feels, and how that changes."""
