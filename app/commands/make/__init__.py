"""The commands that make what a character does: speech, behaviour, gestures, motions."""
