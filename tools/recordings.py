"""Makes the bundled recordings: `python -m tools.recordings [NAME …]`.

The pictures come from the synthetic camera, so that they can be made again by anyone, and so that
the truth is known. The files hold only what came in: what the program makes of it is computed when
it is needed, and is described in `tests/golden`.
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from rich.console import Console

from cubeling.app.commands.play.progress import run_with_progress
from cubeling.app.running.opening import open_session
from cubeling.app.session import SessionOptions
from cubeling.app.session.bundled import RECORDED_SCENARIOS
from cubeling.app.session.copying import keep_inputs

FOLDER = Path(__file__).parent.parent / "recordings"

MAX_RECORDING_BYTES = 3_000_000
"""Greatest size of a bundled recording [B]."""


def make(name: str, console: Console) -> None:
    """Record one scenario from its synthetic script, and refuse a file that is too large."""
    path = FOLDER / f"{name}.mcap"
    with TemporaryDirectory() as folder:
        full, inputs = Path(folder) / "full.mcap", Path(folder) / path.name
        options = SessionOptions(
            scenario=name, source=f"synthetic:{name}", record=full, pictures=False, robot="none"
        )
        with open_session(options) as session:
            summary = run_with_progress(session, console, f"recording {path.name}")
        keep_inputs(full, inputs)
        size = inputs.stat().st_size
        if size > MAX_RECORDING_BYTES:
            raise SystemExit(
                f"{path.name} would be {size / 1e6:.1f} MB; "
                f"the limit is {MAX_RECORDING_BYTES / 1e6:.0f}"
            )
        path.write_bytes(inputs.read_bytes())
    console.print(summary)
    console.print(f"{path.name}: {size / 1e6:.1f} MB")


if __name__ == "__main__":
    for chosen in sys.argv[1:] or RECORDED_SCENARIOS:
        make(chosen, Console())
