"""The bundled dinosaur."""
