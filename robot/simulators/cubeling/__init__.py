"""The protocol "cubeling", the robot's end: a simulated dinosaur."""
