"""The checks, a file for each subject of PROTOCOL.md."""
