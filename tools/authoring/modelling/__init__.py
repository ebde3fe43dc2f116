"""Modelling, rigging and animating by code: what the bundled characters share."""
