"""What is in a recorded session, and what differs between two."""
