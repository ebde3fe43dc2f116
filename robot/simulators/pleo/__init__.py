"""A simulated Pleo: its body, its own behaviour, and the Pleo Monitor console."""
