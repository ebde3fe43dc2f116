"""Where the command begins: Ctrl-C may come while the program is still being loaded."""

import gc
import sys

from cubeling.app.interrupts import CTRL_C_EXIT_CODE, termination

YOUNG_OBJECTS = 20_000
"""The garbage collector looks at new objects when there are so many of them. Loading makes some
hundred thousand that stay; with Python's 700 a tenth of a start went into looking at them."""


def main() -> None:
    """Load the command line and run it."""
    gc.set_threshold(YOUNG_OBJECTS, 20, 20)
    termination.watch()
    try:
        from cubeling.app.cli import main as run

        run()
    except KeyboardInterrupt:
        sys.exit(termination.exit_code(CTRL_C_EXIT_CODE))
