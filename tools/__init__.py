"""Makes what is bundled: characters, recordings, and the pictures and tables of the documents."""
