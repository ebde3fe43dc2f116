"""What the window shows: the time line, the inspector, cards and bars, of widgets."""
