"""Compares what the program makes of the bundled recordings: `python -m tests.golden [NAME …]`.

With `--renew` it writes the files again.
"""

import argparse
import sys

from rich.console import Console

from cubeling.app.commands.play.complete import complete_session
from cubeling.app.session.bundled import RECORDED_SCENARIOS, bundled_session
from tests.golden import FOLDER, describe, differences, renewed

MOST_SHOWN = 5
"""Differences that are printed for a recording."""


def main() -> int:
    """Compare or renew, and return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", default=list(RECORDED_SCENARIOS))
    parser.add_argument("--renew", action="store_true", help="write the files again")
    arguments = parser.parse_args()
    console, code = Console(highlight=False, markup=False, soft_wrap=True), 0
    for name in arguments.names:
        file = FOLDER / f"{name}.txt"
        golden = file.read_text("utf-8") if file.exists() else ""
        with complete_session(bundled_session(name)) as session:
            now = describe(session)
        found = differences(golden, now)
        if arguments.renew:
            file.write_text(renewed(golden, now), "utf-8")
            console.print(f"{name}: {len(found)} lines renewed, {file.stat().st_size / 1e3:.0f} kB")
        elif found:
            code = 1
            console.print(f"{name}: {len(found)} lines differ", *found[:MOST_SHOWN], sep="\n")
        else:
            console.print(f"{name}: as it was")
    return code


if __name__ == "__main__":
    sys.exit(main())
