"""Films for the bundled studies, made from recordings: of gestures, and of standing people."""
