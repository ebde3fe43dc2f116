"""Motion from recorded motion: graphs of the whole body and of its parts, motion matching."""
