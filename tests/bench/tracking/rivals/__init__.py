"""The trackers that Cubeling is compared with, each in a process and an environment of its own."""
