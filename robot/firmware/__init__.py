"""Firmware of a robot on a microcontroller; only `main.py` and `dino` are copied to the board."""
