"""The commands of `cubeling`, a file each, in a folder for each group of the help.

A group of commands is a folder of its own. A command's module imports at its top only what its help
needs. Its function first checks what needs no more than that, and then imports what does the work:
a help and a wrong argument load neither numpy nor OpenCV.
"""
