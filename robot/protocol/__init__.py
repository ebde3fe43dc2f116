"""The language between a host and a robot: frames, messages, times, and what is drawn from them."""
