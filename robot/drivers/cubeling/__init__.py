"""The protocol "cubeling": the host side."""
