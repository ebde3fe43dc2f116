"""A session of two seconds of each older format, and how they were cut from longer ones."""
