"""The program: cube, character and robot in one line."""

import os
import platform

if platform.machine() in ("x86_64", "AMD64"):
    # OpenBLAS, inside numpy, rounds differently for each family of processors, and a replay would
    # differ in its last bits from one machine to the next. The oldest family's code runs on all of
    # them and costs our small matrices nothing measurable. It must be chosen before numpy is
    # imported.
    os.environ.setdefault("OPENBLAS_CORETYPE", "Nehalem")
