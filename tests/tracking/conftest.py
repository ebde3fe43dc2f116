"""What all tests of this room share."""

from hypothesis import settings

# A shared machine may be slow at any moment; a deadline would fail what is right.
settings.register_profile("no deadline", deadline=None)
settings.load_profile("no deadline")
