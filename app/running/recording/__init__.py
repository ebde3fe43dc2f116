"""The recording of a session: what it keeps, and what it says of program and machine."""
