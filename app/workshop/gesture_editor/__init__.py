"""An editor for symbolic gestures: pure in the middle, with a thin window around it."""
