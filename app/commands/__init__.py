"""The commands of `cubeling`, a file each; a group of commands is a folder."""
