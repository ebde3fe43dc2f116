"""The tracker on photographs that we did not make, beside OpenCV."""
