"""What a person sees: the cards over the picture, the window, the video."""
