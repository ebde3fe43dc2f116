"""Sessions with every channel, for the commands that read them."""

import shlex
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import typer
from rich.console import Console

SHORT_S = 3.0
"""Sessions up to this length are computed without a word [s]."""


@contextmanager
def complete_session(
    path: Path, *, salvage: bool = False, appearance: bool = False
) -> Iterator[Path]:
    """Yield a session with every channel: the file itself, or a temporary one if it lacks some.

    What it lacks is computed first, with a line and a progress bar on standard error; what its
    pictures tell of hand, light and softness only with `appearance`, as it takes longer. It is
    not kept: the pictures of a recording should lie only where their owner put them.

    Raises
    ------
    AppError, TrackingError, CharacterError, AffectError
        The file is no session or was cut off, or cannot be played.
    KeyboardInterrupt
        Ctrl-C ended the computation.
    """
    from cubeling.app.session import SessionFile, write_labels

    with SessionFile(path, salvage=salvage) as session:
        info, is_complete = session.info, session.has_channels
    if is_complete:
        yield path
        return
    # They load all that plays a session, which most sessions do not need here.
    from cubeling.app.commands.play.progress import show_progress
    from cubeling.app.running.computing import compute_channels

    if info.duration > SHORT_S:
        kept = f"cubeling replay {shlex.quote(str(path))} --no-pictures --record FULL.mcap"
        typer.echo(
            f"{path.name} holds only what came in: computing the rest, for about as long as it "
            f"lasts ({info.duration:.0f} s). To do so once: {kept}",
            err=True,
        )
    with TemporaryDirectory(prefix="cubeling-") as folder:
        complete = Path(folder) / f"{path.stem}.mcap"
        with show_progress(
            f"computing {path.name}", info.duration, Console(stderr=True)
        ) as progress:
            compute_channels(path, complete, progress, salvage=salvage, appearance=appearance)
        write_labels(complete, info.labels)  # marks that were made later go with it
        yield complete
