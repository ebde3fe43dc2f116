"""What every driver, port and simulator agrees on."""
