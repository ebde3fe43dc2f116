"""Measures the page in a real browser: `python -m tests.bench.web`."""
