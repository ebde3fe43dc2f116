"""The commands that look at this computer and at characters."""
