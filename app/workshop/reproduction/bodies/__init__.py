"""How bodies are solved, moved and lit: Huang 2013."""
