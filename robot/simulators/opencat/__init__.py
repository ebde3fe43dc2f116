"""A simulated Bittle or Nybble, with the quirks of its board."""
