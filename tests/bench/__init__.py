"""Benchmarks: each prints a table of figures."""

import cubeling as cubeling  # before numpy, whose threads and rounding it sets as in the program
