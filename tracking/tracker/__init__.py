"""The tracker: global search, local search, prediction and the verdict on each frame."""
