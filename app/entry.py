"""Where the command begins: Ctrl-C may come while the program is still being loaded."""

import sys


def main() -> None:
    """Load the command line and run it."""
    try:
        from cubeling.app.cli import main as run
    except KeyboardInterrupt:
        sys.exit(130)
    run()
