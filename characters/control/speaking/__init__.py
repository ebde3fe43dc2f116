"""What body, eyes and face do with a speech besides its gestures, planned when it begins."""
