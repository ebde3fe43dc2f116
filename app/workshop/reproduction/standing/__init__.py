"""How people stand and feel: Egges 2006."""
