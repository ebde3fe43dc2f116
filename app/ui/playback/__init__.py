"""Keys and mouse of the player, and what lies over the picture because of them: no window yet."""
