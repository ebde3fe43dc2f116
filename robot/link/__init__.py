"""Ports, and the link between a port and a driver."""
