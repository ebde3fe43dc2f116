"""Damaged files for every reader of the program: `python -m tests.campaigns.files`."""
