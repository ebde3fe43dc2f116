"""Reachy Mini, by way of its own SDK and daemon: `pip install reachy-mini`."""
