"""Motion that is put together from recordings, a folder for each method."""
