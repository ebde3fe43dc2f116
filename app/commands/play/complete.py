"""Sessions with every channel, for the commands that read them."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from rich.console import Console


@contextmanager
def complete_session(
    path: Path, *, salvage: bool = False, appearance: bool = False
) -> Iterator[Path]:
    """Yield a session with every channel: the file itself, or a temporary one if it lacks some.

    What it lacks is computed first, with a progress bar on standard error; what its pictures tell
    of hand, light and softness only with `appearance`, as it takes longer.

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

    with TemporaryDirectory(prefix="cubeling-") as folder:
        complete = Path(folder) / f"{path.stem}.mcap"
        with show_progress(
            f"computing {path.name}", info.duration, Console(stderr=True)
        ) as progress:
            compute_channels(path, complete, progress, salvage=salvage, appearance=appearance)
        write_labels(complete, info.labels)  # marks that were made later go with it
        yield complete
