"""The program: cube, character and robot in one line."""

import os
import platform
from typing import Any

if platform.machine() in ("x86_64", "AMD64"):
    # OpenBLAS, inside numpy, rounds differently for each family of processors, and a replay would
    # differ in its last bits from one machine to the next. The oldest family's code runs on all of
    # them and costs our small matrices nothing measurable. It must be chosen before numpy is
    # imported.
    os.environ.setdefault("OPENBLAS_CORETYPE", "Nehalem")


def __getattr__(name: str) -> Any:
    """Load `Playground` when it is asked for: the command line starts without it."""
    if name != "Playground":
        raise AttributeError(f"module 'app' has no attribute {name!r}")
    from app import scenarios as scenarios  # registers them: a playground may be made from a name
    from app.pipeline.playground import Playground

    return Playground
