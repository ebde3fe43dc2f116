"""Lets the tests compute and print as the program does on any computer."""

import os

for name in ("FORCE_COLOR", "GITHUB_ACTIONS", "PY_COLORS"):
    os.environ.pop(name, None)  # with them, Typer prints colours without a terminal

import app as app  # noqa: E402  before numpy, whose rounding it sets
