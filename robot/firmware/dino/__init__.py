"""The firmware of a dinosaur robot: copy this folder to the microcontroller.

It needs only MicroPython, and runs unchanged under CPython, as in the tests.
"""
