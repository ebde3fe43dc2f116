"""The bundled sessions: data only, packaged so that `cubeling demo` finds them when installed."""
