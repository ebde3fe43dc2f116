"""From a few recordings of walking and running to clips that can be steered."""
