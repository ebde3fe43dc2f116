"""The protocol "cubeling", the host's end."""
