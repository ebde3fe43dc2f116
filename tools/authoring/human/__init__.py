"""The bundled human."""
