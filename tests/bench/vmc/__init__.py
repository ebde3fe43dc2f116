"""The character on other programs' models, by the VMC protocol."""
