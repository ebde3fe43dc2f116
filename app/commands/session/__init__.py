"""The commands that play, replay and export sessions, a file each."""
