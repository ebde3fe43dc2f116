"""Running a session: what it is made of, and its loop over the frames."""
