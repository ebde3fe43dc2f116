"""The commands of `cubeling`, a file each."""
