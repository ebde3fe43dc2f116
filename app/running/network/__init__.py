"""The session on the network: its players, and robots that follow them."""
