"""A simulated Bittle or Nybble, with the habits of its board."""
