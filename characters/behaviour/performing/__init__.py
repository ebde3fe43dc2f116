"""Performing: what a body does over time for the intents of a `BehaviourIntent`."""
