"""The methods by which a batch of chains is solved, a file each."""
