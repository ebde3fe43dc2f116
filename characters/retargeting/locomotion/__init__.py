"""Locomotion clips that can be steered, made from a few recordings of walking and running."""
