"""Speech: voices, prosody, pitch accents, and the alignment of recordings with their text."""
