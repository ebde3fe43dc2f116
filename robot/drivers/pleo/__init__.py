"""The protocol "pleo": the host side of the Pleo Monitor console."""
