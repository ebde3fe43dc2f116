"""The program: cube, character and robot in one line."""

import os
import platform
from typing import Any

# OpenBLAS, inside numpy, reads these when numpy is imported. Threads gain nothing on our small
# matrices, and on a busy computer they wait for each other: frames took seven times as long.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
if platform.machine() in ("x86_64", "AMD64"):
    # It rounds differently for each family of processors, so the last bits of a replay would differ
    # between machines. The oldest family's code runs on all and costs us nothing measurable.
    os.environ.setdefault("OPENBLAS_CORETYPE", "Nehalem")


def __getattr__(name: str) -> Any:
    """Load `Playground` when it is asked for: the command line starts without it."""
    if name != "Playground":
        raise AttributeError(f"module 'app' has no attribute {name!r}")
    from app import scenarios as scenarios  # registers them: a playground may be made from a name
    from app.pipeline.playground import Playground

    return Playground
