"""The explorer's gestures, and the timeline that all authored gestures share."""
