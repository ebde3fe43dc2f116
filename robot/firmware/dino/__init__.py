"""The program of a dinosaur robot on a microcontroller: copy this folder to the board.

It needs nothing but MicroPython, and runs unchanged under CPython, where the tests are.
"""
