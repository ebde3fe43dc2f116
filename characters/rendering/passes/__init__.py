"""The passes that a picture is drawn in, a file each."""
