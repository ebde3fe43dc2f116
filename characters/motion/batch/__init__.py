"""Many clips for many characters at once."""
