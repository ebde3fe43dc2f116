"""Light measured on the paper of a cube, against the truth of drawn rooms."""
