"""The light from all around, prepared for surfaces that scatter or mirror it."""
