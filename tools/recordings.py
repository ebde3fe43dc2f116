"""Makes the bundled recordings: `python -m tools.recordings [NAME …]`.

The pictures come from the synthetic camera, so that they can be made again by anyone, and so that
the truth is known; everything after the camera is what the program itself did with them.
"""

import sys
from pathlib import Path

from rich.console import Console

from cubeling.app.commands.session.progress import run_with_progress
from cubeling.app.running.opening import open_session
from cubeling.app.scenarios import SCENARIOS
from cubeling.app.session import SessionOptions

FOLDER = Path(__file__).parent.parent / "recordings"

MAX_RECORDING_BYTES = 6_000_000
"""Greatest size of a bundled recording [B]."""


def make(name: str, console: Console) -> None:
    """Record one scenario from its synthetic script, and refuse a file that is too large."""
    path = FOLDER / f"{name}.mcap"
    fresh = path.with_suffix(".partial.mcap")
    fresh.unlink(missing_ok=True)
    options = SessionOptions(
        scenario=name, source=f"synthetic:{name}", record=fresh, pictures=False
    )
    with open_session(options) as session:
        summary = run_with_progress(session, console, f"recording {path.name}")
    size = fresh.stat().st_size
    if size > MAX_RECORDING_BYTES:
        fresh.unlink()
        raise SystemExit(
            f"{path.name} would be {size / 1e6:.1f} MB; "
            f"the limit is {MAX_RECORDING_BYTES / 1e6:.0f}"
        )
    fresh.replace(path)
    console.print(summary)
    console.print(f"{path.name}: {size / 1e6:.1f} MB")


if __name__ == "__main__":
    for chosen in sys.argv[1:] or SCENARIOS:
        make(chosen, Console())
