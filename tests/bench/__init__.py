"""Benchmarks: each prints a table of figures."""

import app as app  # before numpy, whose threads and rounding it sets as in the program
