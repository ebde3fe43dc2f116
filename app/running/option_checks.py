"""What can be refused of a session's options before anything is loaded or opened."""

from cubeling.app.errors import AppError
from cubeling.app.output_path import check_output
from cubeling.app.session import SessionOptions, check_codec
from cubeling.app.ui.output_formats import OUTPUT_SUFFIXES


def check_part(options: SessionOptions) -> None:
    """Refuse a part of a recording that is empty, and what nobody could end."""
    if not options.patience_s >= 0.0:  # also what is no number
        raise AppError(f"--patience is a time of 0 s or more, not {options.patience_s:g}")
    if options.loop and not options.windowed:
        raise AppError("--loop needs a window: a file would never end")
    if options.start_s < 0.0:
        raise AppError(f"--start counts from the first frame: {options.start_s:g} s is before it")
    if options.end_s is not None and options.end_s <= options.start_s:
        raise AppError(
            f"--end {options.end_s:g} is not after --start {options.start_s:g}: nothing is left"
        )


def check_output_paths(options: SessionOptions) -> None:
    """Refuse files that cannot be written."""
    if options.output is not None:
        check_output(options.output, "video", OUTPUT_SUFFIXES, overwrite=options.overwrite)
        if not options.pictures:
            raise AppError(f"without pictures there is nothing to write to '{options.output}'")
    if options.record is not None:
        check_output(options.record, "recording", (".mcap",), overwrite=False, remedy="remove it")
        check_codec(options.codec)
