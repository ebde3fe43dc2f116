"""Behaviour: symbolic gestures, reaching, and the blocks of the Behavior Markup Language."""
