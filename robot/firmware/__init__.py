"""A robot of our own on a microcontroller: `dino` goes on the board, the rest stays on the desk."""
