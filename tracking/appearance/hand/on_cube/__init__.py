"""What hides the print of a tracked cube."""
