"""The protocol "pleo": the host's end of the Pleo Monitor console."""
