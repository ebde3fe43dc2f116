"""The commands of `cubeling`, a file each; a group of commands is a folder.

A command's module imports at its top only what its help needs. Its function first checks what needs
no more than that, and then imports what does the work: a help and a wrong argument load neither
numpy nor OpenCV.
"""
