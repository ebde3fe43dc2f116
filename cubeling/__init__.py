"""Cubeling: a printed cube in your hand, a character on your screen, a robot on your desk.

The rooms are `cubeling.affect`, `cubeling.tracking`, `cubeling.characters`, `cubeling.robot` and
`cubeling.app`. In the repository they are folders at the top level; the build puts them in here.
"""

import os
import platform

# OpenBLAS, inside numpy, reads these when numpy is imported. They stand here and not in a room, so
# that they hold for whichever room a program imports first. Threads gain nothing on our small
# matrices, and on a busy computer they wait for each other: frames took seven times as long.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
if platform.machine() in ("x86_64", "AMD64"):
    # It rounds differently for each family of processors, so the last bits of a replay would differ
    # between machines. The oldest family's code runs on all and costs us nothing measurable.
    os.environ.setdefault("OPENBLAS_CORETYPE", "Nehalem")
