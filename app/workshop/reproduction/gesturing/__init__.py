"""How gestures follow speech: chapters 4 and 8 of Fernández-Baena 2015."""
